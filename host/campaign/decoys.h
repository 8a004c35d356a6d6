#pragma once

#include "host/campaign/scene.h"

namespace sidestep::campaign {

/// Adds spheres at rest of 5 to 80 mm radius to a dodge scene, 0.25 to 0.5 m from the arm at its start, and lets the
/// controller receive all obstacles in a new order in every set. A dodge needs no decoy's place: whatever their number
/// and order, its result should stay the same. Always the same decoys for the same scene.
void add_decoys(Scene& scene, int count);

}  // namespace sidestep::campaign
