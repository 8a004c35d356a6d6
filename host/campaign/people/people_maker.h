#pragma once

#include "host/campaign/random.h"
#include "host/campaign/scene.h"

namespace sidestep::campaign {

/// Completes a scene among people, whose start, goal and duration of a motion between them (motion_s) are given: the
/// tool is held at the start (start and goal are the same), or moves between the two. A part of each person aims at a
/// random point of a moving link at a random time: the near arm of a passer-by, the hand that reaches in or gestures.
/// At the beginning and at the end the persons are 0.15 m or more away from the arm at start and goal, and always 0.15
/// m or more from the axis of the base column, which cannot evade. The base is 0.4 to 0.9 m above the floor.
/// Returns false if no such persons are found for these postures.
bool make_people(Random& random, Scene& scene, double motion_s);

}  // namespace sidestep::campaign
