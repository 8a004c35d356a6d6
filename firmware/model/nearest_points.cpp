#include "firmware/model/nearest_points.h"

namespace sidestep {

NearestPoints nearest_on_segments(const Capsule& a, const Capsule& b) {
  const Vector3 u = a.end - a.start;
  const Vector3 v = b.end - b.start;
  const Vector3 w = a.start - b.start;
  const double uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v), uw = u.dot(w), vw = v.dot(w);
  const double per_uu = uu > 0.0 ? 1.0 / uu : 0.0, per_vv = vv > 0.0 ? 1.0 / vv : 0.0;

  // The nearest point of the infinite lines, clamped to a; then the nearest on b to it, clamped; then again on a and b.
  const double determinant = uu * vv - uv * uv;
  const bool parallel = determinant <= 1e-12 * uu * vv;
  double on_a = parallel ? 0.0 : std::clamp((uv * vw - vv * uw) / determinant, 0.0, 1.0);
  double on_b = std::clamp((uv * on_a + vw) * per_vv, 0.0, 1.0);
  on_a = std::clamp((uv * on_b - uw) * per_uu, 0.0, 1.0);
  on_b = std::clamp((uv * on_a + vw) * per_vv, 0.0, 1.0);
  return {a.start + on_a * u, b.start + on_b * v};
}

}  // namespace sidestep
