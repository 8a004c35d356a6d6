#include "host/sim/solid.h"

#include <fcl/fcl.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <variant>

#include "firmware/model/load/mesh.h"

namespace sidestep::sim {

struct Surface {
  fcl::BVHModel<fcl::OBBRSSd> triangles;
};

namespace {

constexpr double kTouching_m = 1e-12;   // FCL returns 1e-323 for a sphere that cuts a triangle
constexpr double kLeastRange_m = 1e-6;  // of the search for a distance

using Geometry =
    std::variant<fcl::Sphered, fcl::Capsuled, fcl::Boxd, fcl::Cylinderd, const fcl::BVHModel<fcl::OBBRSSd>*>;

Geometry geometry_of(const Solid& solid) {
  const Eigen::Vector3d& size = solid.size_m;
  switch (solid.shape) {
    case Shape::kCapsule:
      return fcl::Capsuled(size.x(), size.y());
    case Shape::kBox:
      return fcl::Boxd(size);
    case Shape::kCylinder:
      return fcl::Cylinderd(size.x(), size.y());
    case Shape::kMesh:
      return &solid.surface->triangles;
    case Shape::kSphere:
      break;
  }
  return fcl::Sphered(size.x());
}

const fcl::CollisionGeometryd* pointer(const Geometry& geometry) {
  struct Address {
    const fcl::CollisionGeometryd* operator()(const fcl::CollisionGeometryd& shape) const { return &shape; }
    const fcl::CollisionGeometryd* operator()(const fcl::CollisionGeometryd* mesh) const { return mesh; }
  };
  return std::visit(Address{}, geometry);
}

bool is_mesh(const Geometry& geometry) {
  return std::holds_alternative<const fcl::BVHModel<fcl::OBBRSSd>*>(geometry);
}

// Zero when touching or penetrating. FCL's signed distance is not used: libccd's expanding polytope fails an assertion
// or runs for seconds on aligned shapes and has errors of centimetres on deep penetrations. Distances by libccd's GJK
// are not used either: they fail an assertion when surfaces just touch. Spheres have closed forms. For other pairs
// FCL's own GJK is exact to 1e-9 m, but for 1 of 500 pairs of boxes it stops too early, with a distance that is too
// large. With the two solids swapped it stops at another point: hence the smaller of both distances. Distances between
// the triangles of two meshes have a closed form.
double gap_m(const Geometry& a, const Eigen::Isometry3d& base_from_a, const Geometry& b,
             const Eigen::Isometry3d& base_from_b, double within_m) {
  fcl::DistanceRequestd request;
  request.gjk_solver_type = fcl::GST_INDEP;
  request.distance_tolerance = 1e-12;
  const double range_m = std::max(within_m, kLeastRange_m);
  fcl::DistanceResultd there(range_m), back(range_m);
  const double gap = fcl::distance(pointer(a), base_from_a, pointer(b), base_from_b, request, there);
  if (std::holds_alternative<fcl::Sphered>(a) || std::holds_alternative<fcl::Sphered>(b)) return std::max(gap, 0.0);
  if (is_mesh(a) && is_mesh(b)) return std::max(gap, 0.0);
  const double other = fcl::distance(pointer(b), base_from_b, pointer(a), base_from_a, request, back);
  return gap > 0.0 && other > 0.0 ? std::min(gap, other) : std::max({gap, other, 0.0});
}

double depth_m(const Geometry& a, const Eigen::Isometry3d& base_from_a, const Geometry& b,
               const Eigen::Isometry3d& base_from_b) {
  const fcl::CollisionRequestd request(8, true);
  fcl::CollisionResultd result;
  fcl::collide(pointer(a), base_from_a, pointer(b), base_from_b, request, result);
  double depth = 0.0;
  for (size_t i = 0; i < result.numContacts(); ++i) {
    depth = std::max(depth, std::abs(result.getContact(i).penetration_depth));
  }
  return depth;
}

// How far one of two cylinders has to move across both axes until they are separate. FCL's depth of long cylinders that
// cross is up to their length.
double depth_across_m(const Solid& a, const Eigen::Isometry3d& base_from_a, const Solid& b,
                      const Eigen::Isometry3d& base_from_b) {
  const Eigen::Vector3d offset = base_from_b.translation() - base_from_a.translation();
  const Eigen::Vector3d axis = base_from_a.linear().col(2), normal = axis.cross(base_from_b.linear().col(2));
  const double apart_m =
      normal.norm() > 1e-9 ? std::abs(offset.dot(normal.normalized())) : offset.cross(axis).norm();  // or parallel axes
  return a.size_m.x() + b.size_m.x() - apart_m;
}

// Least value of a convex function on [low, high], by golden-section search.
template <typename Function>
double least_value(const Function& function, double low, double high) {
  const double golden = (std::sqrt(5.0) - 1.0) / 2.0;
  double left = high - golden * (high - low), right = low + golden * (high - low);
  double at_left = function(left), at_right = function(right);
  for (int i = 0; i < 50; ++i) {
    if (at_left < at_right) {
      high = right, right = left, at_right = at_left;
      at_left = function(left = high - golden * (high - low));
    } else {
      low = left, left = right, at_left = at_right;
      at_right = function(right = low + golden * (high - low));
    }
  }
  return std::min(at_left, at_right);
}

// Uses that the signed distance between a convex solid and the sphere at a point of the capsule's axis is a convex
// function of that point.
double capsule_distance_m(const Solid& other, const Eigen::Isometry3d& base_from_other, const Solid& capsule,
                          const Eigen::Isometry3d& base_from_capsule) {
  const Solid sphere{Shape::kSphere, {capsule.size_m.x(), 0.0, 0.0}};
  const auto distance_at = [&](double z_m) {
    const Eigen::Isometry3d base_from_sphere = base_from_capsule * Eigen::Translation3d(0.0, 0.0, z_m);
    return signed_distance_m(other, base_from_other, sphere, base_from_sphere);
  };
  return least_value(distance_at, -capsule.size_m.y() / 2.0, capsule.size_m.y() / 2.0);
}

}  // namespace

std::string to_yaml(const Solid& solid) {
  const Eigen::Vector3d& size_m = solid.size_m;
  switch (solid.shape) {
    case Shape::kCapsule:
      return fmt::format("shape: capsule, radius_m: {}, length_m: {}", size_m.x(), size_m.y());
    case Shape::kCylinder:
      return fmt::format("shape: cylinder, radius_m: {}, height_m: {}", size_m.x(), size_m.y());
    case Shape::kBox:
      return fmt::format("shape: box, edges_m: [{}, {}, {}]", size_m.x(), size_m.y(), size_m.z());
    case Shape::kSphere:
    case Shape::kMesh:
      break;
  }
  return fmt::format("shape: sphere, radius_m: {}", size_m.x());
}

double bounding_radius_m(const Solid& solid) {
  const Eigen::Vector3d& size = solid.size_m;
  switch (solid.shape) {
    case Shape::kCapsule:
      return size.x() + size.y() / 2.0;
    case Shape::kBox:
    case Shape::kMesh:
      return size.norm() / 2.0;
    case Shape::kCylinder:
      return std::hypot(size.x(), size.y() / 2.0);
    case Shape::kSphere:
      break;
  }
  return size.x();
}

CentredMesh load_mesh_solid(const std::string& name, const std::string& urdf_file,
                            const std::vector<std::string>& package_path, const Eigen::Vector3d& scale) {
  const Mesh mesh = load_mesh(find_mesh(name, urdf_file, package_path), scale);
  Eigen::Vector3d lower_m = mesh.vertices.front(), upper_m = lower_m;
  for (const Eigen::Vector3d& p : mesh.vertices) lower_m = lower_m.cwiseMin(p), upper_m = upper_m.cwiseMax(p);
  const Eigen::Vector3d centre_m = 0.5 * (lower_m + upper_m);

  std::vector<fcl::Vector3d> corners;
  for (const Eigen::Vector3d& p : mesh.vertices) corners.push_back(p - centre_m);
  std::vector<fcl::Triangle> triangles;
  for (const auto& [a, b, c] : mesh.triangles)
    triangles.emplace_back(static_cast<size_t>(a), static_cast<size_t>(b), static_cast<size_t>(c));
  const auto surface = std::make_shared<Surface>();
  surface->triangles.beginModel();
  surface->triangles.addSubModel(corners, triangles);
  surface->triangles.endModel();
  return {{Shape::kMesh, upper_m - lower_m, surface}, centre_m};
}

double signed_distance_m(const Solid& a, const Eigen::Isometry3d& base_from_a, const Solid& b,
                         const Eigen::Isometry3d& base_from_b, double within_m) {
  const Geometry a_geometry = geometry_of(a), b_geometry = geometry_of(b);
  const double gap = gap_m(a_geometry, base_from_a, b_geometry, base_from_b, within_m);
  const bool boxes = a.shape == Shape::kBox && b.shape == Shape::kBox;  // the only pair with a gap > 0 in contact
  if (gap > kTouching_m && !boxes) return gap;
  if (b.shape == Shape::kCapsule) return capsule_distance_m(a, base_from_a, b, base_from_b);
  if (a.shape == Shape::kCapsule) return capsule_distance_m(b, base_from_b, a, base_from_a);
  double depth = depth_m(a_geometry, base_from_a, b_geometry, base_from_b);
  if (a.shape == Shape::kCylinder && b.shape == Shape::kCylinder)
    depth = std::min(depth, depth_across_m(a, base_from_a, b, base_from_b));
  return depth > 0.0 ? -depth : gap;
}

}  // namespace sidestep::sim
