#pragma once

#include "firmware/model/types.h"

namespace sidestep {

/// The gap between a segment (the axis of a link) and a convex solid, all in one frame, m.
struct SegmentGap {
  double
      distance_m;  ///< from the segment to the surface; if they overlap, minus the shortest translation that parts them
  Vector3 on_segment;  ///< the point of the segment nearest to the solid; if they overlap, its deepest point
  Vector3 on_solid;    ///< the point of the solid's surface with on_segment = on_solid + distance_m * normal
  Vector3 normal;      ///< unit, from the solid to the segment; if they overlap, along that translation
};

}  // namespace sidestep
