#pragma once

#include <vector>

#include "firmware/control/cycle.h"
#include "firmware/model/proximity.h"

namespace sidestep::bench {

/// The baseline: the minimum that a controller computes to keep a whole arm clear of obstacles. Forward kinematics; the
/// distances of the moving links to every sphere and of the self-pairs, with nearest points and normal, by
/// measure_pair(); the tool's Jacobian and its damped least-squares inverse. No prediction, constraint rows, limits or
/// shield.
struct BaselineCycle {
  std::vector<Proximity> pairs;  ///< allocated in the first call
  JointVector velocity_radps;

  void run(const Model& model, const JointVector& q_rad, const ObstacleSet& spheres, const Vector3& target_m);
};

/// Distance only: the same with the least distance to the spheres instead of all pairs. A controller could not keep
/// clear with it.
struct DistanceOnlyCycle {
  double nearest_m;
  JointVector velocity_radps;

  void run(const Model& model, const JointVector& q_rad, const ObstacleSet& spheres, const Vector3& target_m);
};

}  // namespace sidestep::bench
