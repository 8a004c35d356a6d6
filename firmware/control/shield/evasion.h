#pragma once

#include "firmware/control/shield/shield_qp.h"

namespace sidestep {

/// Improves the plan of the shield where it fails to evade. The rows are linear and fix the side on which each obstacle
/// is passed; evasion checks the plan in rollouts of the arm's real motion and compares other candidates.
///
/// Rollout: the arm accelerates to a constant joint velocity at its limits, in steps of 70 ms, until 0.2 s after the
/// last obstacle that comes closer than pass_clearance has passed; the obstacles of the near pairs (at most 16) move at
/// constant velocity.
/// Trigger: a pass row demands a motion of the link, and the plan's rollout comes closer than hard_clearance.
/// Candidates: the evasion of the previous cycle, the plan, the solution of the programme for every combination of
/// passing sides of the first 4 two-sided pass rows (at most 15), and each joint alone at either end of its range.
/// Cost: the joint and tool terms of the objective (QpObjective), plus 1e4 per metre by which the rollout misses
/// hard_clearance. The evasion of the previous cycle counts with a factor of 0.8, so that the arm does not alternate
/// between two candidates.
///
/// `planned_radps` is the plan, n x 1; `rows` and `range` are those of its programme. Work is bounded: at most 15
/// programmes and 18 + 2 n rollouts for n joints; none where the trigger does not hold.
Plan evade(const ShieldSettings& settings, const ShieldInput& input, const ConstraintRows& rows,
           const VelocityRange& range, const QpObjective& objective, const JointVector& planned_radps);

}  // namespace sidestep
