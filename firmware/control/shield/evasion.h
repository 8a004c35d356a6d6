#pragma once

#include "firmware/control/shield/shield_qp.h"

namespace sidestep {

/// Improves the plan of the shield where it fails to evade. The rows are linear and fix the side on which each obstacle
/// is passed. Evasion simulates the arm's motion with the plan and with other candidates.
///
/// Rollout: the arm changes from the last commanded velocity to that of the candidate at its acceleration limits and
/// keeps it, in steps of 70 ms. The obstacles move at constant velocity; they are those of the near pairs, of more than
/// 16 obstacles the first 16 in the order of the pairs. Every near pair whose closest approach is below pass_clearance
/// has a time of closest approach; the rollout ends 0.2 s after the latest of them. Pairs of links are not examined.
///
/// Trigger: a pass row has b > 0, and the clearance in the plan's rollout falls below hard_clearance.
///
/// Candidates:
///   - the plan, and the evasion of the previous cycle
///   - the solutions of the programme with other passing sides: in every combination of the two-sided pass rows (at
///     most the first 4 of them, so up to 15 further combinations) row and bound are replaced by -row and other_bound
///   - each joint at the lower or upper bound of the range with the other joints at rest
///
/// Cost: the joint and tool terms of the objective (QpObjective), plus 1e4 per metre by which the rollout falls short
/// of hard_clearance. The cost of the previous cycle's evasion is multiplied by 0.8, so that the arm does not alternate
/// between two candidates. The cheapest candidate becomes the plan.
///
/// `planned_radps` is the plan, n x 1; `rows` and `range` are those of its programme. Bounded: at most 15 programmes,
/// of up to 3 solutions each, and 18 + 2 n rollouts for n joints (two of the plan, one of the previous evasion).
/// Without the trigger there is one rollout, without a pass row with b > 0 none.
Plan evade(const ShieldSettings& settings, const ShieldInput& input, const ConstraintRows& rows,
           const VelocityRange& range, const QpObjective& objective, const JointVector& planned_radps);

}  // namespace sidestep
