#include "firmware/io/config/surroundings.h"

#include <fmt/format.h>

#include <cmath>

namespace sidestep {
namespace {

constexpr double kLeastSize_m = 1e-4, kLargestSize_m = 100.0, kFarthest_m = 1000.0;

double read_size(Section& section, const std::string& key) {
  if (!section.has(key)) section.fail(key, "is missing");
  double size_m = 0.0;
  section.number(key, size_m, kLeastSize_m, kLargestSize_m);
  return size_m;
}

Vector3 read_vector(Section& section, const std::string& key, double lowest, double highest) {
  if (!section.has(key)) section.fail(key, "is missing");
  Vector3 vector = Vector3::Zero();
  section.numbers(key, vector, lowest, highest);
  return vector;
}

Matrix3 read_rotation(Section& section) {
  Eigen::Vector4d wxyz(1, 0, 0, 0);
  section.numbers("quaternion", wxyz, -1.001, 1.001);
  if (!(std::abs(wxyz.norm() - 1.0) < 1e-3)) section.fail("quaternion", "must have length 1 (order w x y z)");
  return Quaternion(wxyz[0], wxyz[1], wxyz[2], wxyz[3]).normalized().toRotationMatrix();
}

Obstacle read_obstacle(Section& section) {
  std::string shape;
  section.choice("shape", shape, {"sphere", "capsule", "box"});
  const Vector3 centre = read_vector(section, "position_m", -kFarthest_m, kFarthest_m);
  if (shape == "sphere") return sphere_obstacle(centre, read_size(section, "radius_m"));
  const Matrix3 rotation = read_rotation(section);
  if (shape == "box")
    return box_obstacle(centre, rotation, read_vector(section, "edges_m", kLeastSize_m, kLargestSize_m));
  const double radius_m = read_size(section, "radius_m");
  return capsule_obstacle(centre, rotation, radius_m, read_size(section, "length_m"));
}

}  // namespace

std::vector<Obstacle> read_surroundings(Section& config) {
  std::vector<Obstacle> surroundings;
  for (Section& section : config.sections("surroundings")) {
    surroundings.push_back(read_obstacle(section));
    surroundings.back().id = -1 - static_cast<int>(surroundings.size());
    section.finish();
  }
  if (surroundings.size() > kMaxSurroundings)
    config.fail("surroundings", fmt::format("more than {}", kMaxSurroundings));
  return surroundings;
}

}  // namespace sidestep
