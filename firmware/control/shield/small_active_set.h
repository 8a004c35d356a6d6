#pragma once

#include <optional>

#include "firmware/control/shield/qp_objective.h"

namespace sidestep {

/// The velocity in range nearest to the wish that meets the rows, where that is simple: the wish itself, or, where the
/// tool does not count, what the range leaves of it, or what few rows make of it. Exact; else nothing: where more rows
/// or the range are against it, or a hard row has to be given up. Bounded.
std::optional<QpSolution> solve_small_active_set(const ConstraintRows& rows, const VelocityRange& range,
                                                 const QpObjective& objective);

}  // namespace sidestep
