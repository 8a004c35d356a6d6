#pragma once

#include "firmware/control/shield/shield_qp.h"

namespace sidestep {

/// Improves the plan of the shield where it fails to evade. The rows are linear and fix the side on which each obstacle
/// is passed. Evasion simulates the arm's motion with the plan and with other candidates.
///
/// Rollout: the arm changes from the last commanded velocity to that of the candidate at its acceleration limits and
/// keeps it, in steps of 70 ms. The obstacles of the
/// near pairs (the first 16) move at constant velocity. It ends 0.2 s after the last closest approach below
/// pass_clearance. Trigger: a pass row has b > 0, and the plan's rollout falls below hard_clearance. Candidates: the
/// evasion of the previous cycle; the plan; the solutions of the programme with other passing sides of the two-sided
/// pass rows (the first 4 in the list: up to 15 further combinations); each joint at the lower or upper bound of the
/// range with the other joints at rest. Cost: the joint and tool terms of the objective (QpObjective), plus 1e4 per
/// metre by which the rollout falls short of hard_clearance. The cost of the previous cycle's evasion is multiplied by
/// 0.8, so that the arm does not alternate between two candidates.
///
/// `planned_radps` is the plan, n x 1; `rows` and `range` are those of its programme. Bounded: at most 15 programmes
/// and 18 + 2 n rollouts for n joints (two of the plan, one of the previous evasion); without the trigger one rollout,
/// without a pass row with b > 0 none.
Plan evade(const ShieldSettings& settings, const ShieldInput& input, const ConstraintRows& rows,
           const VelocityRange& range, const QpObjective& objective, const JointVector& planned_radps);

}  // namespace sidestep
