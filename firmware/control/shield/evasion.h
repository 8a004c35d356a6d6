#pragma once

#include "firmware/control/shield/shield_qp.h"

namespace sidestep {

/// Improves the plan of the shield where it fails to evade. The rows are linear and fix the side on which each obstacle
/// is passed. Evasion simulates the arm's motion with the plan and with other candidates.
///
/// Rollout: the arm changes from the last commanded velocity to that of the candidate at its acceleration limits and
/// keeps it, in steps of 70 ms. The obstacles of the near pairs move at constant velocity. At most 16 obstacles take
/// part: those whose pairs have the least distances, now or at the closest approach. The rollout ends 0.2 s after the
/// latest time of closest approach that counts (approach_counts()) among the near pairs that come closer than
/// pass_clearance. Pairs of links are not examined.
///
/// Trigger: a pass row has b > 0, and the clearance in the plan's rollout falls below hard_clearance (for
/// obstacles at rest: what they need, required_clearance.h). More than 0.3 s ahead the clearance may be less by 0.05 m
/// for each further second, down to contact: the obstacle may turn away, and later cycles can still evade it. An arm
/// that stops or keeps separation from a person keeps the full clearance.
///
/// Candidates:
///   - the plan, and the evasion of the previous cycle
///   - the solutions of the programme with other passing sides. At most 4 two-sided rows (constraint_rows.h) are
///     considered, those with the largest b. Each of them keeps its side or changes it; that gives up to 15 programmes
///     besides that of the plan
///   - each joint at the lower or upper bound of the range with the other joints at rest
///   - the nominal velocity (within the range) plus a velocity in the null space of the tool's task, along the
///     projection of each joint on it, forward and backward; as large as the range permits, a half and a quarter of
///     that. Of a null space of one dimension the longest projection is enough
///   - of an arm that stops, and thus follows no guide, where the cheapest of these still comes to contact: it with one
///     joint at the lower bound, at rest or at the upper bound, joint by joint, each time from the cheapest so far
///
/// Cost: the joint and tool terms of the objective (QpObjective), plus 1e4 per metre by which the rollout falls short
/// of that; for a position max(1e4, 167 w). A candidate that falls shorter than the plan is no solution. The cost of
/// the previous cycle's evasion is multiplied by 0.8, so that the arm does not alternate between two candidates. The
/// cheapest candidate becomes the plan. While the arm keeps separation from a person near it
/// (ShieldInput::person_weight), the plan takes the place of the nominal velocity in the cost: it makes room, and the
/// nominal velocity leads back to the target.
///
/// `planned_radps` is the plan, n x 1; `rows` and `range` are those of its programme. Bounded: at most 15 programmes,
/// of up to 3 solutions each, and 18 + 12 n rollouts for n joints (two of the plan, one of the previous evasion).
/// Without the trigger there is one rollout, without a pass row with b > 0 none.
Plan evade(const ShieldSettings& settings, const ShieldInput& input, const ConstraintRows& rows,
           const VelocityRange& range, const QpObjective& objective, const JointVector& planned_radps);

}  // namespace sidestep
