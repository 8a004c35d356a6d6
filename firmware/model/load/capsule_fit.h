#pragma once

#include <vector>

#include "firmware/model/capsule.h"
#include "firmware/model/load/mesh.h"

namespace sidestep {

/// Capsules that together enclose a mesh, in the mesh's frame.
struct CapsuleFit {
  std::vector<Capsule> capsules;
  double slack_m = 0.0;  ///< largest distance from the capsules' outer surface to the mesh, at sampled points
};

/// A capsule of nearly the least volume that contains all points (at least one), m. Its axis direction is the best of a
/// search with refinement; its radius and ends are then the least for that direction.
Capsule capsule_around(const std::vector<Vector3>& points);

/// Encloses a mesh by one capsule, or by up to `most` capsules, one for each of as many slices of equal thickness
/// across the single capsule's axis. More slices are used only where the slack is above 10 mm and they reduce it below
/// 75 %. Each capsule contains the mesh and its inside between two cuts.
CapsuleFit fit_capsules(const Mesh& mesh, int most);

}  // namespace sidestep
