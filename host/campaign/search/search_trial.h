#pragma once

#include "host/campaign/search/search_scene.h"
#include "host/campaign/trial_controller.h"

namespace sidestep::campaign {

/// The closest approach of arm and obstacles in one trial.
struct ClosestApproach {
  double clearance_m = sim::kNothingNear;  ///< negative: contact, also of two links
  double t_s = 0.0;
};

/// Runs one controller through one scene: ideal plant, exact obstacles in every cycle. The scene is frozen until the
/// controller is ready; its first ready cycle is t = 0. Throws std::runtime_error if that takes more than 5 s.
ClosestApproach run_search_trial(const SearchScene& scene, TrialController& controller);

}  // namespace sidestep::campaign
