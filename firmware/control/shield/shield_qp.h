#pragma once

#include "firmware/control/shield/qp_objective.h"

namespace sidestep {

/// Solves the programme of shield.h, its rounds included, for the given rows, range and objective. The result is within
/// the range. Hard rows yield last. Comfort rows yield before pass rows near the target; far from it the default
/// weights make both tiers equally expensive. A round takes at most 200 iterations. If the solver fails in the first
/// round, the result is the nominal velocity clipped to the range; in a later round, the solution of the round before.
QpSolution solve(const ConstraintRows& rows, const VelocityRange& range, const QpObjective& objective);

}  // namespace sidestep
