#pragma once

#include "firmware/io/config/config.h"
#include "host/campaign/problems/problem_files.h"

namespace sidestep::campaign {

/// The configuration with the joints outside the chain at the problem's positions, as far as the arm has them.
Config config_for(const Problem& problem, const Config& config);

}  // namespace sidestep::campaign
