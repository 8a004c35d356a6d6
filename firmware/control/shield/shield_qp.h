#pragma once

#include "firmware/control/shield/qp_objective.h"

namespace sidestep {

/// Solves the programme of shield.h for the given rows, range and objective. Always returns a velocity within the
/// range: the rows of a tier share one slack, and the slack scales make comfort rows yield before pass rows and these
/// before hard rows. Where hard rows are violated, the violated ones are frozen at their slack and the others are
/// solved again, in at most 3 rounds. Each round takes at most 200 iterations. Should the solver fail in the first
/// round, the result is the nominal velocity clipped to the range; in a later round, the solution of the round before.
QpSolution solve(const ConstraintRows& rows, const VelocityRange& range, const QpObjective& objective);

}  // namespace sidestep
