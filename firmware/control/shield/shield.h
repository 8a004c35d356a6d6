#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include "firmware/control/types/settings.h"
#include "firmware/model/clearance.h"
#include "firmware/model/prediction.h"
#include "firmware/model/velocity_range.h"

namespace sidestep {

/// The input of the shield besides the nominal velocity. Everything is in the base frame, at the time of the cycle.
struct ShieldInput {
  const Arm& arm;
  const LinkPoses& poses;
  const JointVector& position_rad;         ///< measured
  const JointVector& commanded_rad;        ///< the position that was commanded last
  const JointVector& last_velocity_radps;  ///< last commanded
  const Clearance& clearance;
  const ObstacleView& obstacles;
  const std::vector<SelfPair>& self_pairs;
  const JointVector& evasion_radps;  ///< the evasion chosen in the previous cycle; size 0: none
  double period_s;
  double comfort_weight;          ///< weight of the comfort tier in this cycle, s2/m2
  double tool_weight;             ///< w in this cycle, 1/m2
  double person_weight = 0.0;     ///< of the separation from persons in this cycle; 0: comfort as from anything else
  bool is_stopping = false;       ///< the arm follows no guide: evasion tries more, defers nothing (evasion.h)
  double step_tool_weight = 0.0;  ///< w of the second programme, 1/m2; 0: the joints follow the plan one by one
};

/// Whether the obstacle of a pair is a person.
inline bool is_person(const ShieldInput& input, const NearPair& pair) {
  return input.obstacles.at(pair.now.obstacle).kind == Kind::kPerson;
}

/// Whether a link keeps separation from the obstacle of a pair, a person, in place of comfort.
inline bool keeps_separation(const ShieldInput& input, const NearPair& pair) {
  return input.person_weight > 0.0 && is_person(input, pair);
}

/// Whether a link keeps separation from any person.
inline bool keeps_separation(const ShieldInput& input) {
  const auto& near = input.clearance.near;
  return std::any_of(near.begin(), near.end(), [&](const NearPair& pair) { return keeps_separation(input, pair); });
}

/// Whether the closest approach that is predicted for a pair counts. A person from whom the arm keeps separation keeps
/// its velocity for kPersonCoast_s only (model/prediction.h): limbs turn back.
inline bool approach_counts(const ShieldInput& input, const NearPair& pair) {
  return pair.approach.time_s <= kPersonCoast_s || !keeps_separation(input, pair);
}

/// The result of the first programme: the joint velocity that the arm is to reach, before acceleration limits, and
/// whether evasion replaced it (evasion.h).
struct Plan {
  JointVector velocity_radps;
  bool evading = false;
};

/// The pair of links with the least room: the distance above its clearance.
struct NearestLinks {
  int first = -1, second = -1;  ///< indices into Arm::shapes; -1: there is no pair
  double distance_m = std::numeric_limits<double>::quiet_NaN();
};

struct ShieldResult {
  JointVector velocity_radps;   ///< for the coming period, within `range`
  double hard_slack_mps = 0.0;  ///< largest s_hard of the second programme; up to 1e-4 all hard rows count as met
  bool failed = false;          ///< the solver failed in one of the two programmes: rest took the place of its solution
  Plan plan;
  NearestLinks nearest_links;
  bool links_limit = false;  ///< the nominal velocity violates the hard row of a pair of links
};

/// The safety filter (a quadratic programme with control barrier functions): the joint velocity q' nearest to the
/// nominal velocity u that keeps the clearances.
///
///   min   1/2 |S^-1 (q' - u)|^2 + w/2 |J (q' - u)|^2 + sum over tiers t of 1/2 (s_t / sigma_t)^2
///   s.t.  a_i q' + s_t(i) >= b_i    every constraint row i, of tier t(i)      (constraint_rows.h; at most 56 rows)
///         s_t >= 0                  one slack for all rows of a tier, m/s
///         l <= q' <= h              the range of joint velocities             (model/velocity_range.h)
///
///   u        nominal joint velocity, n x 1, rad/s (prismatic joints: m/s)
///   S        diag(Arm::joint_scale): 0.25 m/s of a prismatic joint weigh as much as 1 rad/s
///   J        tool Jacobian, 3 x n or 6 x n; 1 rad of its angular rows counts as 1 m, while
///            the target pose moves as 0.1 m
///   w        ShieldInput::tool_weight, 1/m2: this term makes the arm avoid obstacles in
///            the null space of the tool's task where that is possible
///   a_i      1 x n: rate at which the distance of pair i grows with q';  b_i: least such rate, m/s
///   sigma_t  slack scale of tier t, m/s: a violation s costs 1/2 (s / sigma_t)^2. hard 1e-3, pass 3e-2,
///            comfort 1 / sqrt(comfort_weight) of the cycle: 2.2 at the target, 3e-2 far from it by default
///
/// Two programmes a cycle. The first gives the plan: all three tiers, within `sustainable`. Evasion may replace this
/// plan, and solves further programmes for it (evasion.h). The second programme gives the velocity of the coming
/// period: u is the plan, only the hard tier, within `range`, which includes the acceleration limits. Where these keep
/// some joints from the plan, the others make up for it, so that the tool moves as planned: w is step_tool_weight.
/// It is 0 for an evasion and where a pass row is urgent, because the arm would evade later, and where there are hard
/// rows, which would be met less exactly.
///
/// Every programme has a solution because of the slacks. If the solver nevertheless fails, rest takes the place of the
/// solution (shield_qp.h).
///
/// A solution with s_hard > 1e-4 m/s violates hard rows. All hard rows share this slack, also those that could be met
/// without it. Therefore the programme is solved again with fixed bounds for the rows that need the whole slack: a row
/// with a q' + s_hard = b becomes a q' >= b - s_hard. Only the other hard rows still have the slack, which is then as
/// small as they permit. A programme is solved at most 3 times in all.
ShieldResult shield(const ShieldSettings& settings, const ShieldInput& input, const VelocityRange& sustainable,
                    const VelocityRange& range, const TaskJacobian& tool_jacobian, const JointVector& nominal_radps);

}  // namespace sidestep
