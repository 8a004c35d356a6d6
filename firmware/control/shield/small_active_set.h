#pragma once

#include <optional>

#include "firmware/control/shield/qp_objective.h"

namespace sidestep {

/// Solves the programme of shield.h exactly where at most three constraint rows are active at the solution and no bound
/// of the range is; without the tool's cost (w = 0) the nominal velocity is first clipped to the range. Returns nothing
/// in every other case: more active rows, an active bound, a hard slack above kNegligibleSlack_mps, or no active set
/// found within 6 changes. Then shield_qp.h needs the general solver. With H = I + w J^T J and active rows A, b:
///
///   stationarity     q' = u + H^-1 A^T lambda                      lambda >= 0, one multiplier per active row
///   slack            s_t = sigma_t^2 sum of lambda_i over the active rows i of tier t
///   active rows      (A H^-1 A^T + S) lambda = b - A u             S_ij = sigma_t^2 for two rows of tier t, else 0
///   Woodbury         H^-1 = I - J^T (J J^T + I/w)^-1 J
std::optional<QpSolution> solve_small_active_set(const ConstraintRows& rows, const VelocityRange& range,
                                                 const QpObjective& objective);

}  // namespace sidestep
