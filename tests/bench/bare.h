#pragma once

#include "firmware/model/clearance.h"

namespace sidestep::bench {

/// The least that a controller among obstacles has to compute: forward kinematics, the distance of every moving link to
/// every sphere, the tool's Jacobian and its damped least-squares inverse. No prediction, no shield, no limits.
struct Bare {
  JointVector velocity_radps;
  double nearest_m;
};

Bare bare_cycle(const Arm& arm, const JointVector& q_rad, const ObstacleSet& spheres, const Vector3& target_m);

}  // namespace sidestep::bench
