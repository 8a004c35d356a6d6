#pragma once

#include "firmware/model/nearest_points.h"
#include "firmware/model/proximity.h"

namespace sidestep {

/// The Proximity (without its indices) of a link to a point or segment grown by radius_m. points: the nearest points;
/// gap = points.a - points.b; gap_m = |gap|. Where gap_m <= 1e-9 the normal is some direction perpendicular to the
/// link's axis; z if the link is a sphere.
inline Proximity proximity_of(const Capsule& link, double radius_m, const NearestPoints& points, const Vector3& gap,
                              double gap_m) {
  Proximity pair;
  pair.on_arm = points.a;
  pair.on_obstacle = points.b;
  pair.axis_distance_m = gap_m;
  pair.distance_m = gap_m - link.radius_m - radius_m;
  if (gap_m > 1e-9)
    pair.normal = gap / gap_m;
  else if (link.end != link.start)
    pair.normal = (link.end - link.start).unitOrthogonal();
  return pair;
}

}  // namespace sidestep
