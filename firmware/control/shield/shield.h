#pragma once

#include <utility>
#include <vector>

#include "firmware/control/types/settings.h"
#include "firmware/model/clearance.h"
#include "firmware/model/velocity_range.h"

namespace sidestep {

/// The input of the shield besides the nominal velocity. Everything is in the base frame, at the time of the cycle.
struct ShieldInput {
  const Arm& arm;
  const LinkPoses& poses;
  const JointVector& position_rad;         ///< measured
  const JointVector& last_velocity_radps;  ///< last commanded
  const Clearance& clearance;
  const ObstacleView& obstacles;
  const std::vector<std::pair<int, int>>& self_pairs;
  const JointVector& evasion_radps;  ///< the evasion chosen in the previous cycle; size 0: none
  double period_s;
  double comfort_weight;  ///< weight of the comfort tier in this cycle, s2/m2
};

/// The joint velocity that the arm is to reach, and whether evasion chose it (evasion.h).
struct Plan {
  JointVector velocity_radps;
  bool evading = false;
};

struct ShieldResult {
  JointVector velocity_radps;   ///< for the coming period, within `range`
  double hard_slack_mps = 0.0;  ///< by how much the worst hard row is violated; 0 where all hard rows are met
  Plan plan;
};

/// The safety filter (a quadratic programme with control barrier functions): the joint velocity q' nearest to the
/// nominal velocity u that keeps the clearances.
///
///   min   1/2 |q' - u|^2 + w/2 |J (q' - u)|^2 + sum over tiers t of 1/2 (s_t / sigma_t)^2
///   s.t.  a_i q' + s_t(i) >= b_i    every constraint row i, of tier t(i)      (constraint_rows.h)
///         s_t >= 0                  one slack for all rows of a tier, m/s
///         l <= q' <= h              the range of joint velocities             (model/velocity_range.h)
///
///   u        nominal joint velocity, n x 1, rad/s
///   J        tool Jacobian, 3 x n or 6 x n;  w = ShieldSettings::tool_weight: with it, obstacles are avoided in the
///            null space of the tool's task where possible
///   a_i      1 x n: rate at which the distance of pair i grows with q';  b_i: least such rate, m/s
///   sigma_t  slack scale of tier t, m/s: the smaller, the more a violation costs. hard 1e-3, pass 3e-2,
///            comfort 1 / sqrt(comfort_weight) of the cycle
///
/// It is solved twice. First for the plan: all three tiers, within `sustainable`, the velocities that the joints can
/// sustain; evasion may replace the solution by a better one. Then for the coming period: u is the plan, w = 0, only
/// the hard tier, within `range`, which includes the acceleration limits.
///
/// Where the hard rows cannot all be met, the solution with the least common slack is found first; the rows that need
/// this slack are then frozen at it, and the remaining hard rows are met as well as possible, in at most 3 solves.
ShieldResult shield(const ShieldSettings& settings, const ShieldInput& input, const VelocityRange& sustainable,
                    const VelocityRange& range, const TaskJacobian& tool_jacobian, const JointVector& nominal_radps);

}  // namespace sidestep
