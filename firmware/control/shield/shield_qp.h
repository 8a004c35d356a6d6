#pragma once

#include "firmware/control/shield/qp_objective.h"

namespace sidestep {

/// The velocity in range nearest to the wish that meets the rows. Always feasible: a tier's rows are given up together,
/// as little as possible, comfort before pass before hard; of the hard rows the worst first, so that the others do not
/// suffer for it. Bounded iterations; should the solver fail, the wish clipped into the range.
QpSolution solve(const ConstraintRows& rows, const VelocityRange& range, const QpObjective& objective);

}  // namespace sidestep
