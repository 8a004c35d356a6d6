#pragma once

#include "firmware/model/types.h"

namespace sidestep {

/// All points within `radius_m` of the segment start-end. A sphere is a capsule whose ends coincide.
struct Capsule {
  Vector3 start;
  Vector3 end;
  double radius_m;
};

/// The two nearest points of two segments; `a` on the first, `b` on the second.
struct NearestPoints {
  Vector3 a;
  Vector3 b;
};

/// Point of the segment start-end that is nearest to p. All in one frame, m.
Vector3 nearest_on_segment(const Vector3& start, const Vector3& end, const Vector3& p);

/// Nearest points of the axes of two capsules; well defined for points and for parallel segments too.
NearestPoints nearest_on_axes(const Capsule& a, const Capsule& b);

/// The capsule along the longest edge of a box, in the box's frame, that holds all eight corners. Edges in m.
Capsule capsule_around_box(const Vector3& edges_m);

/// Whether all of `inner` lies in `outer`.
bool contains(const Capsule& outer, const Capsule& inner);

}  // namespace sidestep
