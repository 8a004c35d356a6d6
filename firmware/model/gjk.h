#pragma once

#include <limits>

#include "firmware/model/convex_solid.h"

namespace sidestep {

/// The gap between two convex solids a and b, base frame, m. The points lie on the cores: on_a = on_b + core_m *
/// normal.
struct SolidGap {
  double distance_m;  ///< between the surfaces, negative if they overlap: core_m less both radii
  double core_m;      ///< between the cores; if they overlap, minus the length of a translation of a along normal that
                      ///< parts them
  Vector3 on_a;
  Vector3 on_b;
  Vector3 normal;  ///< unit, from b to a
};

/// The algorithm of Gilbert, Johnson and Keerthi (1988) over the cores, at most 64 steps, no allocation, no state
/// between calls. The distance is exact to 1e-7 m, mostly to 1e-9 m, of cores that touch to 1e-6 m, and
/// never NaN for finite solids.
///
/// Overlapping cores have no nearest points. Then the normal is the best of the directions that the iteration tried, of
/// the face normals of both cores and of `guess`, which bounds the depth from above: no shorter translation along one
/// of these parts them. on_a is the point of a that is the nearest after that translation and 1 cm more.
///
/// guess: a direction from b to a, not zero, of any length; the better, the fewer steps.
/// enough_m: where the distance is proven to be at least this, the search ends; distance_m is then a lower bound of it,
/// and at least enough_m, and points and normal are approximate.
SolidGap gap_between(const ConvexSolid& a, const ConvexSolid& b, const Vector3& guess,
                     double enough_m = std::numeric_limits<double>::infinity());

/// The distance_m of gap_between() alone. Of overlapping cores the depth is only bounded from above, by the directions
/// that the iteration tried, which takes a fraction of the time.
double distance_between_m(const ConvexSolid& a, const ConvexSolid& b, const Vector3& guess, double enough_m);

}  // namespace sidestep
