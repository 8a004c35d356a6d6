#pragma once

#include <array>
#include <cstdint>

#include "firmware/model/box.h"
#include "firmware/model/capsule.h"
#include "firmware/model/convex_solid.h"

namespace sidestep {

/// Values as in obstacle_t. Links have shapes of their own (body_shape.h). To add a shape of obstacles:
///   - here: the value, a maker, and the core's data if the capsule does not hold it, with transformed(),
///     extrapolated() and inflation_m();
///   - model/proximity.cpp: its core (nearest points to a segment) and one case in with_core(), the only switch over
///     shapes for distances, closest approaches and bounds;
///   - control/validation.cpp: reported_obstacle() makes it from its size, plausible() checks new data;
///   - lcmtypes/obstacle_t.lcm and io/lcm/message_decoder.cpp (static_assert), io/lcm/obstacle_encoder.cpp;
///   - io/config/yaml_geometry.cpp for configurations and scenarios, library/sidestep.h for callers.
enum class Shape : int8_t { kSphere = 0, kCapsule = 1, kBox = 2, kCylinder = 3 };

/// Values as in obstacle_t.
enum class Kind : int8_t { kThing = 0, kPerson = 1 };

/// Ids at or below this one belong to the links of other arms.
constexpr int32_t kNeighbourIds = -10000;

/// An obstacle with its velocity at one instant, in the base frame: a core, grown by inflation_m(). The core is a point
/// (sphere), the segment capsule.start - capsule.end (capsule), box_of() (box) or the cylinder about that segment with
/// the radius half_thickness_m.
///
/// `capsule` encloses the obstacle whatever its shape; cheap tests use it alone. The obstacle's centre is the middle of
/// the capsule's axis, and the obstacle turns about it. A capsule without length is treated as a sphere.
struct Obstacle {
  int32_t id = 0;
  Shape shape = Shape::kSphere;
  Capsule capsule{Vector3::Zero(), Vector3::Zero(),
                  0.0};  ///< encloses the obstacle; for a box its axis is parallel to the longest edge
  Vector3 velocity_mps = Vector3::Zero();  ///< of the centre
  Vector3 angular_velocity_radps = Vector3::Zero();
  Vector3 half_width_m = Vector3::Zero();  ///< half the second longest edge of a box, as a vector; other shapes: 0
  double half_thickness_m = 0.0;  ///< half the shortest edge of a box, which may be 0; radius of a cylinder; else 0
  Kind kind = Kind::kThing;
  Vector3 mean_velocity_mps = Vector3::Zero();  ///< of the centre of a person that walks; 0: unknown or negligible
  Vector3 lead_mps = Vector3::Zero();  ///< the part of velocity_mps that it will only have shortly (MotionEstimator)
};

/// Whether it moves, turns or walks, however slowly.
inline bool is_moving(const Obstacle& obstacle) {
  return !obstacle.velocity_mps.isZero(0.0) || !obstacle.angular_velocity_radps.isZero(0.0) ||
         !obstacle.mean_velocity_mps.isZero(0.0);
}

/// The full set of obstacles at one instant. About 800 kB: it lives in a triple buffer or on the heap, never on a
/// stack.
struct ObstacleSet {
  int count = 0;
  int remembered = 0;  ///< the last `remembered` of the `count` obstacles are not reported but remembered
  std::array<Obstacle, kMaxObstacles> obstacles;
};

/// The obstacle expressed in frame b, given in frame a. The frames do not move relative to each other.
Obstacle transformed(const Eigen::Isometry3d& b_from_a, const Obstacle& obstacle);

/// Obstacles at rest. `rotation` is base_from_obstacle; a capsule lies along its own z axis, length_m from cap centre
/// to cap centre; a cylinder along its own z axis. A box whose second longest edge is below 2e-6 m becomes a capsule of
/// Shape::kCapsule along the longest, a cylinder lower than 2e-6 m a sphere.
Obstacle sphere_obstacle(const Vector3& centre, double radius_m);
Obstacle capsule_obstacle(const Vector3& centre, const Matrix3& rotation, double radius_m, double length_m);
Obstacle cylinder_obstacle(const Vector3& centre, const Matrix3& rotation, double radius_m, double height_m);
Obstacle box_obstacle(const Vector3& centre, const Matrix3& rotation, const Vector3& edges_m);

/// The box of an obstacle of Shape::kBox, without its inflation: edges ordered from the longest to the shortest.
Box box_of(const Obstacle& obstacle);

/// The exact shape: the core with its inflation.
ConvexSolid solid_of(const Obstacle& obstacle);

/// Distance from the core to the surface, m. For a sphere or capsule it is the radius. A reported box or cylinder has
/// 0. To let an obstacle grow, its capsule.radius_m is increased; for a box or cylinder the result is this increase.
double inflation_m(const Obstacle& obstacle);

/// Velocity of the obstacle's material at a point, m/s.
Vector3 velocity_at(const Obstacle& obstacle, const Vector3& point);

/// The obstacle dt_s later (earlier if negative), at constant linear and angular velocity.
Obstacle extrapolated(const Obstacle& obstacle, double dt_s);

}  // namespace sidestep
