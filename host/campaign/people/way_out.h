#pragma once

#include "host/campaign/scene.h"

namespace sidestep::campaign {

/// State of the arm at a period of a scene.
struct ArmInstant {
  int period;
  Joints q_rad, qd_radps;
};

/// Whether a motion without contact was found from this state to the end of the scene, knowing how the persons will
/// move. A random tree: from an instant of a motion found so far the arm moves to a random posture, each joint as fast
/// as its velocity and acceleration limits permit. The search keeps 10 mm between persons and the capsules that enclose
/// the links; what it finds is checked as the judge would, at the same instants, links against each other included.
/// Bounded: at most 400 motions. `false` therefore means that none was found.
bool has_way_out(const Scene& scene, const ArmInstant& from);

/// Least clearance of an arm that stays at the scene's start, at the instants at which the judge looks.
double clearance_at_rest(const Scene& scene);

}  // namespace sidestep::campaign
