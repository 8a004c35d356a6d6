#pragma once

#include "host/campaign/random.h"
#include "host/campaign/scene.h"

namespace sidestep::campaign {

/// Completes a dodge scene: the task is to hold the tool where it is at `start_rad`, while each sphere flies straight
/// through a random point of a random moving link, all at the same time. A sphere starts 0.9 m before its point and
/// clear of the arm; its line keeps 0.25 m from the axis of the base column. The scene ends two seconds after the pass.
/// Returns false if no such lines are found for the posture.
bool make_dodge(Random& random, Scene& scene, const Joints& start_rad);

}  // namespace sidestep::campaign
