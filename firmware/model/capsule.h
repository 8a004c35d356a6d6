#pragma once

#include "firmware/model/types.h"

namespace sidestep {

/// All points within `radius_m` of the segment start-end, its axis. A capsule whose ends coincide is a sphere.
struct Capsule {
  Vector3 start;
  Vector3 end;
  double radius_m;

  Vector3 centre() const;
  /// From the centre to the farthest point, m.
  double extent_m() const;
  bool is_sphere() const { return start.x() == end.x() && start.y() == end.y() && start.z() == end.z(); }
};

/// The capsule that encloses a box centred at the origin, in the box's frame. Its axis is the full longest edge; its
/// radius reaches the corners. Edges in m.
Capsule capsule_around_box(const Vector3& edges_m);

/// Whether all of `inner` lies in `outer`, with a tolerance of 1e-9 m.
bool contains(const Capsule& outer, const Capsule& inner);

}  // namespace sidestep
