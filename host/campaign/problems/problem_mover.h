#pragma once

#include <atomic>

#include "host/campaign/problems/problem_trial.h"

namespace sidestep::campaign {

/// The problems with a ball that crosses the arm's way (furniture/mover.h), as "<kind>@mover", always the same for the
/// same problem. Without those for which no witness is found that keeps 2 mm from the objects, or no such ball. Fewer
/// when `stop` became true. Throws std::runtime_error, one line.
std::vector<Problem> with_movers(const std::vector<Problem>& problems, const Config& config, int jobs, bool quiet,
                                 const std::atomic<bool>& stop);

}  // namespace sidestep::campaign
