#pragma once

#include <optional>

#include "firmware/control/shield/qp_objective.h"

namespace sidestep {

/// Finds the exact solution of the programme of shield.h, or returns nothing. It can find it only in two cases:
///   - at the solution at most three constraint rows are active and no bound of the range is;
///   - w = 0, and u clipped to the range meets all rows (with H = I the joints are independent, so clipping is exact).
/// It returns nothing with a hard slack above kNegligibleSlack_mps, or if 6 changes of the active set do not find
/// the solution. With H = I + w J^T J and the active rows A, b:
///
///   stationarity     q' = u + H^-1 A^T lambda                      lambda >= 0, one multiplier per active row
///   slack            s_t = sigma_t^2 sum of lambda_i over the active rows i of tier t
///   active rows      (A H^-1 A^T + S) lambda = b - A u             S_ij = sigma_t^2 for two rows of tier t, else 0
///   Woodbury         H^-1 = I - J^T (J J^T + I/w)^-1 J             for w > 0
std::optional<QpSolution> solve_small_active_set(const ConstraintRows& rows, const VelocityRange& range,
                                                 const QpObjective& objective);

}  // namespace sidestep
