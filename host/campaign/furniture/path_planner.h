#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "host/campaign/judge_arm.h"

namespace sidestep::campaign {

/// Between two checks of a planned path every joint moves by less than this; what is in between is not looked at.
constexpr double kPlannedStep_rad = 0.02;

/// Plans a joint path with OMPL's RRT-Connect, which shares nothing with the controller's planner, and shortens it.
struct PlanningProblem {
  Joints start_rad, goal_rad;
  Limits range;  ///< finite positions; the other limits do not count
  std::function<bool(const Joints&)> is_valid;
  uint32_t seed;
  int most_checks;  ///< of is_valid, until a path is found
};

/// The postures between which the path is straight, start and goal included; empty if none was found. The same for the
/// same problem. May be called from several threads.
std::vector<Joints> plan_path(const PlanningProblem& problem);

}  // namespace sidestep::campaign
