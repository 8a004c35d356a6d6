#include "firmware/model/capsule.h"

#include <algorithm>
#include <cmath>

namespace sidestep {

NearestPoints nearest_on_segments(const Capsule& a, const Capsule& b) {
  const Vector3 u = a.end - a.start;
  const Vector3 v = b.end - b.start;
  const Vector3 w = a.start - b.start;
  const double uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v), uw = u.dot(w), vw = v.dot(w);

  // Nearest on the infinite lines, clamped to a; then the nearest on b to that, clamped; then once more on a.
  const double determinant = uu * vv - uv * uv;
  const bool parallel = determinant <= 1e-12 * uu * vv;
  const double s = parallel ? 0.0 : std::clamp((uv * vw - vv * uw) / determinant, 0.0, 1.0);
  const Vector3 on_b = nearest_on_segment(b.start, b.end, a.start + s * u);
  const Vector3 on_a = nearest_on_segment(a.start, a.end, on_b);
  return {on_a, nearest_on_segment(b.start, b.end, on_a)};
}

Capsule capsule_around_box(const Vector3& edges_m) {
  int longest = 0;
  edges_m.maxCoeff(&longest);
  Vector3 half = Vector3::Zero();
  half[longest] = 0.5 * edges_m[longest];
  const double radius_m = 0.5 * std::sqrt(edges_m.squaredNorm() - edges_m[longest] * edges_m[longest]);
  return {-half, half, radius_m};
}

bool contains(const Capsule& outer, const Capsule& inner) {
  const auto reach = [&](const Vector3& p) {
    return (p - nearest_on_segment(outer.start, outer.end, p)).norm() + inner.radius_m;
  };
  const double slack_m = 1e-9;
  return std::max(reach(inner.start), reach(inner.end)) <= outer.radius_m + slack_m;
}

}  // namespace sidestep
