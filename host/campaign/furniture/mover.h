#pragma once

#include "host/campaign/random.h"
#include "host/campaign/scene.h"

namespace sidestep::campaign {

/// Adds a sphere that flies straight past the scene's witness while that moves, and touches no furniture during the
/// whole scene (witness_fit.h). Returns false if none is found.
bool draw_mover(Random& random, Scene& scene);

}  // namespace sidestep::campaign
