#pragma once

#include "host/campaign/random.h"
#include "host/campaign/scene.h"

namespace sidestep::campaign {

/// Plans the witness of a scene with furniture, from start_rad to goal_rad (path_planner.h): it keeps_clear() and takes
/// 80 % of the limits. Sets witness_path and witness_s. Returns false if none is found.
bool plan_witness(Random& random, Scene& scene, double clearance_m);

/// Whether the arm in this posture keeps clearance_m from the scene's furniture, by the judge's surfaces, and the
/// witness's distances from itself.
bool keeps_clear(const Scene& scene, const Joints& q_rad, double clearance_m);

}  // namespace sidestep::campaign
