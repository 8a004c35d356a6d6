#pragma once

#include "firmware/control/shield/qp_objective.h"

namespace sidestep {

/// Solves the programme of shield.h for the given rows, range and objective, with the repeated solutions for violated
/// hard rows. Tries solve_small_active_set() first, then the dual active-set solver of eiquadprog (Goldfarb-Idnani)
/// with at most 200 iterations. The result is within the range. Hard rows yield last. Comfort rows yield before pass
/// rows near the target; far from it the default weights make both tiers equally expensive. If eiquadprog fails, the
/// result is its previous solution of the same programme, or the nominal velocity clipped to the range if there is
/// none.
QpSolution solve(const ConstraintRows& rows, const VelocityRange& range, const QpObjective& objective);

}  // namespace sidestep
