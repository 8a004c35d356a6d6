#include "firmware/model/velocity_range.h"

#include <algorithm>
#include <cmath>

namespace sidestep {

double stopping_velocity(double gap_rad, double acceleration_radps2, double period_s) {
  if (std::isinf(gap_rad)) return gap_rad;
  // v T + v^2 / (2 a) = gap: after one more period at v, braking at a just reaches the limit.
  const double aT = acceleration_radps2 * period_s;
  const double v = std::sqrt(aT * aT + 2.0 * acceleration_radps2 * std::abs(gap_rad)) - aT;
  return std::copysign(v, gap_rad);
}

VelocityRange sustainable_range(const JointLimits& limits, const JointVector& lowest_rad,
                                const JointVector& highest_rad, double period_s) {
  VelocityRange range{lowest_rad, highest_rad};
  for (Eigen::Index i = 0; i < lowest_rad.size(); ++i) {
    const double a = limits.acceleration_radps2[i], v_max = limits.velocity_radps[i];
    const double down = -stopping_velocity(lowest_rad[i] - limits.lower_rad[i], a, period_s);
    const double up = stopping_velocity(limits.upper_rad[i] - highest_rad[i], a, period_s);
    range.lower_radps[i] = std::clamp(down, -v_max, v_max);
    range.upper_radps[i] = std::max(std::clamp(up, -v_max, v_max), range.lower_radps[i]);
  }
  return range;
}

double stopping_time_s(const JointLimits& limits, const JointVector& velocity_radps) {
  return (velocity_radps.array().abs() / limits.acceleration_radps2.array()).maxCoeff();
}

VelocityRange velocity_range(const JointLimits& limits, const JointVector& lowest_rad, const JointVector& highest_rad,
                             const JointVector& last_velocity_radps, double period_s) {
  VelocityRange range = sustainable_range(limits, lowest_rad, highest_rad, period_s);
  for (Eigen::Index i = 0; i < lowest_rad.size(); ++i) {
    const double change = limits.acceleration_radps2[i] * period_s;
    const double slowest = last_velocity_radps[i] - change, fastest = last_velocity_radps[i] + change;
    range.lower_radps[i] = std::clamp(range.lower_radps[i], slowest, fastest);
    range.upper_radps[i] = std::clamp(range.upper_radps[i], slowest, fastest);
  }
  return range;
}

}  // namespace sidestep
