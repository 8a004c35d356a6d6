#pragma once

#include "host/campaign/random.h"
#include "host/campaign/scene.h"

namespace sidestep::campaign {

/// Clearance that the witness keeps from the furniture, by the judge's surfaces.
constexpr double kFurnitureClearance_m = 0.01;

/// Draws start, goal, furniture and, if the family has one, the mover of a scene, and plans its witness: a joint path
/// that keeps kFurnitureClearance_m from the furniture, the controller's distances between links, the joint limits and,
/// in time, kWitnessClearance_m from the mover (witness_fit.h). Plain tracking and the straight joint path to the goal
/// touch the furniture. Returns false if these draws give no such scene.
bool make_furniture(Random& random, Scene& scene);

}  // namespace sidestep::campaign
