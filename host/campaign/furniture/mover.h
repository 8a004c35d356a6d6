#pragma once

#include "host/campaign/random.h"
#include "host/campaign/scene.h"

namespace sidestep::campaign {

/// Adds a sphere that flies straight past the scene's witness while that moves (witness_fit.h), through a place where
/// the arm of the witness is up to 1.5 s earlier or later. It touches no furniture during the whole scene. Returns
/// false if none is found.
bool draw_mover(Random& random, Scene& scene);

}  // namespace sidestep::campaign
