#pragma once

#include <cmath>

#include "firmware/control/shield/constraint_rows.h"

namespace sidestep {

/// What "nearest to the wish" means: |q' - wish|^2 + tool_weight |J (q' - wish)|^2.
struct QpObjective {
  const JointVector& nominal_radps;
  const TaskJacobian& tool_jacobian;
  double tool_weight;     ///< 1/m2
  double comfort_weight;  ///< of the comfort rows against nearness, s2/m2
};

/// A velocity and what it costs.
struct QpSolution {
  JointVector velocity_radps;
  double cost = 0.0;            ///< half the nearness, and what was given up of the rows
  double hard_slack_mps = 0.0;  ///< by how much the worst hard row had to be given up
};

/// All rows of a tier are given up by as much as the worst of them, which costs half the square of that over the square
/// of this, m/s.
constexpr double kHardSlackScale_mps = 1e-3;
constexpr double kPassSlackScale_mps = 3e-2;

inline double slack_scale(const QpObjective& near, Tier tier) {
  if (tier == Tier::kHard) return kHardSlackScale_mps;
  if (tier == Tier::kPass) return kPassSlackScale_mps;
  return 1.0 / std::sqrt(near.comfort_weight);
}

/// A hard row that is given up by less than this is none that the others could hide behind.
constexpr double kNegligibleSlack_mps = 1e-4;

}  // namespace sidestep
