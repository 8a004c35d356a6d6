#pragma once

#include "firmware/model/segment_gap.h"

namespace sidestep {

/// A box of any pose. Edges may be 0 (a plate, a line, a point).
struct Box {
  Vector3 centre;
  Matrix3 axes;    ///< unit vectors along its edges, as columns
  Vector3 half_m;  ///< half the length of each edge
};

/// The gap between the segment start-end and a box. Exact, and continuous in all arguments except for the choice
/// between equally near points. Takes about as long as a dozen point-to-box distances.
SegmentGap gap_to_box(const Vector3& start, const Vector3& end, const Box& box);

}  // namespace sidestep
