#pragma once

#include "firmware/model/types.h"

namespace sidestep {

/// A box anywhere. Edges may be nil.
struct Box {
  Vector3 centre;
  Matrix3 axes;    ///< unit vectors along its edges, as columns
  Vector3 half_m;  ///< half its edges
};

/// How a segment lies to a box.
struct BoxGap {
  double distance_m;   ///< negative: how far the segment, as it is, has to move to be out of the box
  Vector3 on_segment;  ///< nearest point; the deepest one when they overlap
  Vector3 on_box;      ///< nearest point of the surface
  Vector3 normal;      ///< unit, from the box to the segment; when they overlap the shortest way out
};

/// Exact, continuous, all in one frame. About as much work as a dozen distances from a point to the box.
BoxGap gap_to_box(const Vector3& start, const Vector3& end, const Box& box);

}  // namespace sidestep
