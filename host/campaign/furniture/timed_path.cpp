#include "host/campaign/furniture/timed_path.h"

#include <algorithm>
#include <cmath>

namespace sidestep::campaign {

TimedPath::TimedPath(std::vector<Joints> knots_rad, const Limits& limits, double share)
    : knots_rad_(std::move(knots_rad)), times_s_{0.0} {
  for (size_t k = 1; k < knots_rad_.size(); ++k) {
    const Joints way_rad = (knots_rad_[k] - knots_rad_[k - 1]).cwiseAbs();
    // The profile's largest velocity is 1.5 way / duration, its largest acceleration 6 way / duration^2.
    const double by_speed_s = (1.5 * way_rad).cwiseQuotient(share * limits.velocity_radps).maxCoeff();
    const double by_acceleration_s2 = (6.0 * way_rad).cwiseQuotient(share * limits.acceleration_radps2).maxCoeff();
    times_s_.push_back(times_s_.back() + std::max({by_speed_s, std::sqrt(by_acceleration_s2), 1e-3}));
  }
}

double TimedPath::length_rad() const {
  double length_rad = 0.0;
  for (size_t k = 1; k < knots_rad_.size(); ++k) length_rad += (knots_rad_[k] - knots_rad_[k - 1]).norm();
  return length_rad;
}

size_t TimedPath::segment_end(double t_s) const {
  const auto end = std::upper_bound(times_s_.begin() + 1, times_s_.end() - 1, t_s);
  return static_cast<size_t>(end - times_s_.begin());
}

Joints TimedPath::position_rad(double t_s) const {
  if (t_s <= 0.0) return knots_rad_.front();
  if (t_s >= duration_s()) return knots_rad_.back();
  const size_t k = segment_end(t_s);
  const double u = (t_s - times_s_[k - 1]) / (times_s_[k] - times_s_[k - 1]);
  return knots_rad_[k - 1] + (3.0 - 2.0 * u) * u * u * (knots_rad_[k] - knots_rad_[k - 1]);
}

Joints TimedPath::velocity_radps(double t_s) const {
  if (t_s <= 0.0 || t_s >= duration_s()) return Joints::Zero(knots_rad_.front().size());
  const size_t k = segment_end(t_s);
  const double duration_s = times_s_[k] - times_s_[k - 1], u = (t_s - times_s_[k - 1]) / duration_s;
  return 6.0 * u * (1.0 - u) / duration_s * (knots_rad_[k] - knots_rad_[k - 1]);
}

}  // namespace sidestep::campaign
