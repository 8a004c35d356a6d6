#pragma once

#include "firmware/model/types.h"

namespace sidestep {

/// The y, n x 1, that minimises |A y - b|^2 + lambda^2 |y|^2 subject to lower <= y <= upper, for an m x n matrix A with
/// m at most 6 and lambda > 0. Primal active set method: it starts from y = 0, clamped; an unknown that reaches a bound
/// is fixed there and the others make up for it; it is released where that lowers the cost. The cost falls in every
/// round; after 4 n rounds, more than random problems need, the best y so far is returned. No allocation.
JointVector bounded_least_squares(const TaskJacobian& a, const TaskVector& b, double lambda, const JointVector& lower,
                                  const JointVector& upper);

}  // namespace sidestep
