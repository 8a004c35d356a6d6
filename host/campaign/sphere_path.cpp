#include "host/campaign/sphere_path.h"

namespace sidestep::campaign {
namespace {

/// Minimum-jerk step from 0 to 1 over u in 0..1, and its integral from 0 to u.
double blend(double u) {
  return u * u * u * (10.0 + u * (-15.0 + u * 6.0));
}
double blend_integral(double u) {
  return u * u * u * u * (2.5 + u * (-3.0 + u));
}

}  // namespace

void SpherePath::add_knot(double duration_s, const Vector3& velocity_mps) {
  const Knot& last = knots_.back();
  const Vector3 position_m =
      last.position_m + duration_s * (last.velocity_mps + blend_integral(1.0) * (velocity_mps - last.velocity_mps));
  knots_.push_back({last.t_s + duration_s, position_m, velocity_mps});
}

PointMotion SpherePath::at(double t_s) const {
  if (t_s <= 0.0) return {knots_.front().position_m, knots_.front().velocity_mps};
  size_t i = knots_.size() - 1;
  while (knots_[i].t_s > t_s) --i;
  const Knot& from = knots_[i];
  const double dt_s = t_s - from.t_s;
  if (i + 1 == knots_.size()) return {from.position_m + dt_s * from.velocity_mps, from.velocity_mps};
  const Knot& to = knots_[i + 1];
  const double duration_s = to.t_s - from.t_s, u = dt_s / duration_s;
  const Vector3 change_mps = to.velocity_mps - from.velocity_mps;
  return {from.position_m + dt_s * from.velocity_mps + duration_s * blend_integral(u) * change_mps,
          from.velocity_mps + blend(u) * change_mps};
}

}  // namespace sidestep::campaign
