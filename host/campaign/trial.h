#pragma once

#include "host/campaign/outcome.h"
#include "host/campaign/pilot.h"

namespace sidestep::campaign {

/// One pilot through one scene: the closed loop around it, in process. The world stands still until the pilot tracks;
/// that cycle is t = 0. Throws std::runtime_error when it never does.
Outcome run_trial(const Scene& scene, Pilot& pilot);

}  // namespace sidestep::campaign
