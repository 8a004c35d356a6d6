#pragma once

#include "firmware/control/shield/qp_objective.h"

namespace sidestep {

/// Solves the programme of shield.h for the given rows, range and objective, with the repeated solutions for violated
/// hard rows. Tries solve_small_active_set() first, then the dual active-set solver of eiquadprog (Goldfarb-Idnani)
/// with at most 200 iterations. The result is within the range. Hard rows yield last. Comfort rows yield before pass
/// rows near the target; far from it the default weights make both tiers equally expensive. If eiquadprog fails
/// when the programme is solved again for violated hard rows, the result is the solution before. If it fails at the
/// first solution, the result is marked as failed; it is then the velocity of the range nearest to rest, the fastest
/// stop that the range permits. A nominal velocity that is not finite gives a result that is not finite.
QpSolution solve(const ConstraintRows& rows, const VelocityRange& range, const QpObjective& objective);

}  // namespace sidestep
