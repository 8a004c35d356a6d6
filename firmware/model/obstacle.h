#pragma once

#include <array>
#include <cstdint>

#include "firmware/model/capsule.h"

namespace sidestep {

/// A moving obstacle in the base frame, as the capsule that encloses it. Its centre is the middle of the capsule's
/// axis.
struct Obstacle {
  int32_t id = 0;
  Capsule capsule{Vector3::Zero(), Vector3::Zero(), 0.0};
  Vector3 velocity_mps = Vector3::Zero();
  Vector3 angular_velocity_radps = Vector3::Zero();
};

/// The full set of obstacles at one instant. Large: lives in a mailbox or on the heap, never on a stack.
struct ObstacleSet {
  int count = 0;
  std::array<Obstacle, kMaxObstacles> obstacles;
};

/// The obstacle in frame a as seen from frame b; the frames do not move against each other.
Obstacle transformed(const Eigen::Isometry3d& b_from_a, const Obstacle& obstacle);

/// Where the obstacle is after dt_s at constant linear and angular velocity.
Capsule moved(const Obstacle& obstacle, double dt_s);

}  // namespace sidestep
