#include "firmware/io/config/yaml_geometry.h"

#include <fmt/format.h>

#include <cmath>

namespace sidestep {
namespace {

constexpr NumberRange kSizeRange_m{1e-4, 100.0};
constexpr NumberRange kTurn_rad{-2.0 * M_PI, 2.0 * M_PI};
constexpr double kUnitLengthTolerance = 1e-3;
constexpr int kFirstId = -2;  // -1 is "no obstacle" in the status

}  // namespace

ShapeSize read_shape(YamlSection& section) {
  const std::string shape = section.choice("shape", {"sphere", "capsule", "box", "cylinder"});
  if (shape == "box") return {ShapeKind::kBox, section.vector("edges_m", kSizeRange_m)};
  const double radius_m = section.number("radius_m", kSizeRange_m);
  if (shape == "sphere") return {ShapeKind::kSphere, {radius_m, 0.0, 0.0}};
  if (shape == "cylinder") return {ShapeKind::kCylinder, {radius_m, section.number("height_m", kSizeRange_m), 0.0}};
  return {ShapeKind::kCapsule, {radius_m, section.number("length_m", kSizeRange_m), 0.0}};
}

Vector3 read_position(YamlSection& section) {
  return section.vector("position_m", kPositionRange_m);
}

Quaternion read_orientation(YamlSection& section) {
  if (!section.has("quaternion")) return Quaternion::Identity();
  const double largest = 1.0 + kUnitLengthTolerance;
  const Eigen::VectorXd wxyz = section.numbers("quaternion", 4, 4, {-largest, largest});
  if (!(std::abs(wxyz.norm() - 1.0) < kUnitLengthTolerance))
    section.fail("quaternion", "must have length 1 (order w x y z)");
  return Quaternion(wxyz[0], wxyz[1], wxyz[2], wxyz[3]).normalized();
}

Eigen::Isometry3d read_world_from_base(YamlSection& neighbours) {
  Vector3 position_m = Vector3::Zero(), rpy_rad = Vector3::Zero();
  neighbours.vector("base_position_m", position_m, kPositionRange_m);
  neighbours.vector("base_rpy_rad", rpy_rad, kTurn_rad);
  return Eigen::Translation3d(position_m) * Eigen::AngleAxisd(rpy_rad.z(), Vector3::UnitZ()) *
         Eigen::AngleAxisd(rpy_rad.y(), Vector3::UnitY()) * Eigen::AngleAxisd(rpy_rad.x(), Vector3::UnitX());
}

std::vector<RestingShape> read_resting_shapes(YamlSection& config) {
  std::vector<RestingShape> shapes;
  for (YamlSection& section : config.sections("surroundings")) {
    RestingShape& entry = shapes.emplace_back();
    entry.id = kFirstId + 1 - static_cast<int32_t>(shapes.size());
    entry.shape = read_shape(section);
    entry.position_m = read_position(section);
    // A sphere has no orientation: there the key is unknown.
    if (entry.shape.kind != ShapeKind::kSphere) entry.orientation = read_orientation(section);
    section.finish();
  }
  if (shapes.size() > kMaxSurroundings) config.fail("surroundings", fmt::format("more than {}", kMaxSurroundings));
  return shapes;
}

}  // namespace sidestep
