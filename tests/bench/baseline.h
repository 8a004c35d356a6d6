#pragma once

#include <vector>

#include "firmware/control/cycle.h"

namespace sidestep::bench {

/// The least that a controller of a whole arm among obstacles has to compute: forward kinematics; the distances of the
/// moving links to every sphere and to one another, with the nearest points and the normal, by the function that
/// measures any pair of capsules; the tool's Jacobian and its damped least-squares inverse. No prediction, no rows, no
/// limits, no shield.
struct BareCycle {
  std::vector<Proximity> pairs;  ///< room for them is made in the first call
  JointVector velocity_radps;

  void run(const Model& model, const JointVector& q_rad, const ObstacleSet& spheres, const Vector3& target_m);
};

/// The same with the least distance to the spheres alone: nothing from which one could keep clear.
struct BarestCycle {
  double nearest_m;
  JointVector velocity_radps;

  void run(const Model& model, const JointVector& q_rad, const ObstacleSet& spheres, const Vector3& target_m);
};

}  // namespace sidestep::bench
