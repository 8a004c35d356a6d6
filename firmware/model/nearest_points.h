#pragma once

#include <algorithm>

#include "firmware/model/capsule.h"

namespace sidestep {

/// The two nearest points of two segments; `a` on the first, `b` on the second.
struct NearestPoints {
  Vector3 a;
  Vector3 b;
};

/// The point of the segment start-end that is nearest to p. All in one frame, m.
inline Vector3 nearest_on_segment(const Vector3& start, const Vector3& end, const Vector3& p) {
  const Vector3 axis = end - start;
  const double length2 = axis.squaredNorm();
  if (length2 <= 0.0) return start;
  return start + std::clamp(axis.dot(p - start) / length2, 0.0, 1.0) * axis;
}

/// Nearest points of the axes of two capsules that are no spheres. Parallel axes have several nearest pairs; one of
/// them is returned.
NearestPoints nearest_on_segments(const Capsule& a, const Capsule& b);

/// Nearest points of the axes of any two capsules. Most obstacles are spheres, so that case is inline and comes first.
inline NearestPoints nearest_on_axes(const Capsule& a, const Capsule& b) {
  if (b.is_sphere()) return {nearest_on_segment(a.start, a.end, b.start), b.start};
  if (a.is_sphere()) return {a.start, nearest_on_segment(b.start, b.end, a.start)};
  return nearest_on_segments(a, b);
}

}  // namespace sidestep
