#pragma once

#include "host/campaign/random.h"
#include "host/campaign/scene.h"

namespace sidestep::campaign {

/// Completes a dodge: from `start_rad` on hold the tool, while each sphere flies straight through a random point of a
/// random moving link, all at the same time. A sphere starts 0.9 m before its point and clear of the arm; its line
/// keeps 0.25 m from the axis of the base column. Lasts until two seconds after the pass. False when the
/// posture leaves no such line.
bool make_dodge(Random& random, Scene& scene, const Joints& start_rad);

}  // namespace sidestep::campaign
