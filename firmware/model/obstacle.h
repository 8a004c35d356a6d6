#pragma once

#include <array>
#include <cstdint>

#include "firmware/model/box.h"
#include "firmware/model/capsule.h"

namespace sidestep {

/// Values as in obstacle_t. To add a shape: a value, a maker and its inflation_m() here; its core and one case in
/// proximity.cpp, the only place that chooses a distance computation by shape; its size in reported_obstacle()
/// (control/validation.cpp) and its encoding in io/lcm/obstacle_encoder.cpp.
enum class Shape : int8_t { kSphere = 0, kCapsule = 1, kBox = 2 };

/// An obstacle with its velocity at one instant, in the base frame. Its centre is the middle of the capsule's axis, and
/// it turns about its centre.
///
/// Its surface lies at inflation_m() around its core: the point or segment `capsule.start`-`capsule.end` for a sphere
/// or capsule, box_of() for a box. `capsule` encloses the obstacle whatever its shape; cheap tests use it alone. An
/// obstacle whose `capsule.is_sphere()` is treated as that sphere.
struct Obstacle {
  int32_t id = 0;
  Shape shape = Shape::kSphere;
  Capsule capsule{Vector3::Zero(), Vector3::Zero(), 0.0};  ///< encloses the obstacle; a box along its longest edge
  Vector3 velocity_mps = Vector3::Zero();                  ///< of the centre
  Vector3 angular_velocity_radps = Vector3::Zero();
  Vector3 half_width_m = Vector3::Zero();  ///< half the second longest edge of a box, as a vector; other shapes: 0
  double half_height_m = 0.0;              ///< half the shortest edge of a box, which may be 0; other shapes: 0
};

/// The full set of obstacles at one instant. About 600 kB: it lives in a triple buffer or on the heap, never on a
/// stack.
struct ObstacleSet {
  int count = 0;
  int remembered = 0;  ///< so many at the end of `count` are remembered obstacles, not reported ones
  std::array<Obstacle, kMaxObstacles> obstacles;
};

/// The obstacle expressed in frame b, given in frame a. The frames do not move relative to each other.
Obstacle transformed(const Eigen::Isometry3d& b_from_a, const Obstacle& obstacle);

/// Obstacles at rest. `rotation` is base_from_obstacle; a capsule lies along its own z axis, length_m from cap centre
/// to cap centre. A box whose second longest edge is below 2e-6 m becomes a capsule of kind kCapsule along the longest.
Obstacle sphere_obstacle(const Vector3& centre, double radius_m);
Obstacle capsule_obstacle(const Vector3& centre, const Matrix3& rotation, double radius_m, double length_m);
Obstacle box_obstacle(const Vector3& centre, const Matrix3& rotation, const Vector3& edges_m);

/// The box of an obstacle of Shape::kBox, without its inflation: edges ordered from the longest to the shortest.
Box box_of(const Obstacle& obstacle);

/// By how much the core of the obstacle has to be grown, m: the radius of a sphere or capsule; 0 for a box as reported,
/// and the growth of `capsule.radius_m` since for a box that was grown.
double inflation_m(const Obstacle& obstacle);

/// Velocity of the obstacle's material at a point, m/s.
Vector3 velocity_at(const Obstacle& obstacle, const Vector3& point);

/// The obstacle dt_s later (earlier if negative), at constant linear and angular velocity.
Obstacle extrapolated(const Obstacle& obstacle, double dt_s);

}  // namespace sidestep
