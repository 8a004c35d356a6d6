#pragma once

#include "host/campaign/metrics.h"
#include "host/campaign/trial_controller.h"

namespace sidestep::campaign {

/// Runs one controller through one scene in an in-process closed loop. The scene is frozen until the controller tracks;
/// its first cycle that tracks is t = 0. Among boxes the trial ends when the goal is reached. Throws std::runtime_error
/// if the controller does not track within 5 s.
TrialMetrics run_trial(const Scene& scene, TrialController& controller);

}  // namespace sidestep::campaign
