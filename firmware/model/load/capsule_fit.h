#pragma once

#include <vector>

#include "firmware/model/capsule.h"
#include "firmware/model/load/mesh.h"

namespace sidestep {

/// Capsules that together enclose a mesh, in its frame.
struct CapsuleFit {
  std::vector<Capsule> capsules;
  double slack_m = 0.0;  ///< how far the surface of the capsules is from the mesh at most, of points sampled on it
};

/// The capsule of about the least volume that holds all points (at least one), m: its axis is searched for, its radius
/// and ends then follow exactly.
Capsule capsule_around(const std::vector<Vector3>& points);

/// Encloses a mesh by one capsule, or cuts it across that capsule's axis into up to `most` slices with a capsule each
/// where this reduces the slack clearly. Each capsule holds all of the mesh (and of its inside) between two cuts.
CapsuleFit fit_capsules(const Mesh& mesh, int most);

}  // namespace sidestep
