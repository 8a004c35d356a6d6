#pragma once

#include <array>
#include <cstdint>

#include "firmware/model/box.h"
#include "firmware/model/capsule.h"

namespace sidestep {

/// Values as in obstacle_t.
enum class Shape : int8_t { kSphere = 0, kCapsule = 1, kBox = 2 };

/// A moving obstacle in the base frame: a sphere, a capsule or a box. Its centre is the middle of the capsule's axis.
struct Obstacle {
  int32_t id = 0;
  Shape shape = Shape::kSphere;
  Capsule capsule{Vector3::Zero(), Vector3::Zero(), 0.0};  ///< it is this, or a box in it: along its longest edge
  Vector3 velocity_mps = Vector3::Zero();
  Vector3 angular_velocity_radps = Vector3::Zero();
  Vector3 half_width_m = Vector3::Zero();  ///< half the second edge of a box; no box: zero
  double half_height_m = 0.0;              ///< half its least edge

  bool is_box() const { return !half_width_m.isZero(0.0); }
};

/// The full set of obstacles at one instant. Large: lives in a mailbox or on the heap, never on a stack.
struct ObstacleSet {
  int count = 0;
  int remembered = 0;  ///< how many at the end are remembered, not reported (obstacle_memory.h)
  std::array<Obstacle, kMaxObstacles> obstacles;
};

/// The obstacle in frame a as seen from frame b; the frames do not move against each other.
Obstacle transformed(const Eigen::Isometry3d& b_from_a, const Obstacle& obstacle);

/// Obstacles at rest. The rotation turns from their own frame to the base; a capsule lies along its z axis.
Obstacle sphere_obstacle(const Vector3& centre, double radius_m);
Obstacle capsule_obstacle(const Vector3& centre, const Matrix3& rotation, double radius_m, double length_m);
Obstacle box_obstacle(const Vector3& centre, const Matrix3& rotation, const Vector3& edges_m);

/// The box that is_box() speaks of.
Box box_of(const Obstacle& obstacle);

/// All within this of the box counts as the obstacle, m: by how much its capsule has grown.
double inflation_m(const Obstacle& obstacle);

/// Velocity of the obstacle's material at a point, m/s.
Vector3 velocity_at(const Obstacle& obstacle, const Vector3& point);

/// The obstacle dt_s later, at constant linear and angular velocity.
Obstacle extrapolated(const Obstacle& obstacle, double dt_s);

}  // namespace sidestep
