#pragma once

#include <cmath>

#include "firmware/control/shield/constraint_rows.h"

namespace sidestep {

/// The objective of the programme in shield.h: 1/2 |S^-1 (q' - u)|^2 + w/2 |J (q' - u)|^2 + sum of 1/2 (s_t /
/// sigma_t)^2.
struct QpObjective {
  const JointVector& nominal_radps;    ///< u, n x 1
  const TaskJacobian& tool_jacobian;   ///< J, 3 x n or 6 x n
  double tool_weight;                  ///< w, 1/m2
  double comfort_weight;               ///< 1 / sigma_comfort^2, s2/m2
  const JointVector* scale = nullptr;  ///< the diagonal of S, n x 1 (Arm::joint_scale); null: all 1
};

struct QpSolution {
  JointVector velocity_radps;   ///< q', n x 1
  double cost = 0.0;            ///< value of the objective
  double hard_slack_mps = 0.0;  ///< s_hard; the largest one where the programme was solved repeatedly
  bool failed = false;          ///< no solution was found: q' is rest, as far as the range permits
};

/// Slack scales sigma_t of the hard and the pass tier, m/s. The slack of a tier is sigma_t^2 times the sum of the
/// multipliers of its active rows. With equal multipliers the hard tier thus yields about a thousandth of what the pass
/// tier yields.
constexpr double kHardSlackScale_mps = 1e-3;
constexpr double kPassSlackScale_mps = 3e-2;

/// sigma_t, m/s: with slack s_t the rows of the tier become a_i q' + s_t >= b_i, at the cost 1/2 (s_t / sigma_t)^2.
inline double slack_scale_mps(const QpObjective& objective, Tier tier) {
  if (tier == Tier::kHard) return kHardSlackScale_mps;
  if (tier == Tier::kPass) return kPassSlackScale_mps;
  return 1.0 / std::sqrt(objective.comfort_weight);
}

/// A hard slack up to this counts as zero: the hard rows are met, and the programme is not solved again.
constexpr double kNegligibleSlack_mps = 1e-4;

}  // namespace sidestep
