#pragma once

#include <vector>

#include "firmware/model/capsule.h"

namespace sidestep {

/// A capsule of nearly the least volume that contains all points (at least one), m. Its axis direction is the best of a
/// search with refinement; its radius and ends are then the least for that direction.
Capsule capsule_around(const std::vector<Vector3>& points);

}  // namespace sidestep
