#pragma once

#include <Eigen/Geometry>

namespace sidestep::sim {

/// The first three have the values of obstacle_t.
enum class Shape { kSphere = 0, kCapsule = 1, kBox = 2, kCylinder = 3 };

/// A shape around its own centre. size_m: sphere {radius, 0, 0}; capsule {radius, distance between the cap centres, 0}
/// and cylinder {radius, length, 0} along local z; box {edge, edge, edge}.
struct Solid {
  Shape shape = Shape::kSphere;
  Eigen::Vector3d size_m = Eigen::Vector3d::Zero();
};

/// Radius of the smallest sphere around the centre that holds the solid, m.
double bounding_radius_m(const Solid& solid);

/// Signed distance between the surfaces of a and b, m, with FCL: zero when touching, negative and finite when they
/// penetrate.
///
/// Exact to 1e-9 m when apart (two boxes: 1e-3 m, rarely a few). Penetration is exact when one of the two is a sphere;
/// for a capsule it is that of the deepest sphere along its axis, exact until the axis itself enters the other solid
/// and a lower bound of the depth from there on; for a box against a box or a cylinder it is an upper bound.
double signed_distance_m(const Solid& a, const Eigen::Isometry3d& base_from_a, const Solid& b,
                         const Eigen::Isometry3d& base_from_b);

}  // namespace sidestep::sim
