#pragma once

#include <optional>

#include "firmware/control/nearness.h"

namespace sidestep {

/// The velocity in range nearest to the wish that meets the rows, where that is simple: the wish itself, or, where the
/// tool does not count, what the range leaves of it, or what few rows make of it. Exact; else nothing: where more rows
/// or the range are against it, or a hard row has to be given up. Bounded.
std::optional<QpSolution> meet_few_rows(const ShieldRows& rows, const VelocityRange& range, const Nearness& nearness);

}  // namespace sidestep
