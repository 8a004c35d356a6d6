#include "firmware/foresight/trapezoidal_profile.h"

#include <algorithm>
#include <cmath>

#include "firmware/base/bounded_list.h"
#include "firmware/model/velocity_range.h"

namespace sidestep {
namespace {

constexpr double kSameTime_s = 1e-4;  // knots are farther apart, so that times increase

/// Until a joint has stopped, at an acceleration above 0. Has the sign of the velocity.
double stopping_rad(double qd_radps, double acceleration_radps2) {
  return 0.5 * qd_radps * std::abs(qd_radps) / acceleration_radps2;
}

}  // namespace

TrapezoidalProfile::TrapezoidalProfile(double displacement_rad, double from_radps, double velocity_limit_radps,
                                       double acceleration_limit_radps2)
    : displacement_rad_(displacement_rad), from_radps_(from_radps) {
  const double stop_rad = stopping_rad(from_radps, acceleration_limit_radps2);
  const double sign = displacement_rad >= stop_rad ? 1.0 : -1.0;  // of the cruise velocity
  // Without a limit of velocity the fastest motion has a peak, and no cruise.
  const double square = 0.5 * from_radps * from_radps + sign * displacement_rad * acceleration_limit_radps2;
  const double peak_radps = std::sqrt(std::max(0.0, square));
  cruise_radps_ = sign * std::min(peak_radps, velocity_limit_radps);
  const double change_radps = cruise_radps_ - from_radps;
  cruise_begins_s_ = std::abs(change_radps) / acceleration_limit_radps2;
  cruise_ends_s_ = cruise_begins_s_;
  if (peak_radps > velocity_limit_radps) {
    const double accelerating_rad = 0.5 * (from_radps + cruise_radps_) * cruise_begins_s_;
    const double cruising_rad =
        displacement_rad - accelerating_rad - stopping_rad(cruise_radps_, acceleration_limit_radps2);
    cruise_ends_s_ += std::max(0.0, cruising_rad / cruise_radps_);
  }
  end_s_ = cruise_ends_s_ + std::abs(cruise_radps_) / acceleration_limit_radps2;
}

double TrapezoidalProfile::position_rad(double at_s) const {
  if (at_s >= end_s_) return displacement_rad_;
  if (at_s < cruise_begins_s_)
    return at_s * (from_radps_ + 0.5 * (cruise_radps_ - from_radps_) * at_s / cruise_begins_s_);
  const double braking_s = end_s_ - cruise_ends_s_;
  if (at_s < cruise_ends_s_) return displacement_rad_ - cruise_radps_ * (cruise_ends_s_ - at_s + 0.5 * braking_s);
  const double left_s = end_s_ - at_s;
  return displacement_rad_ - 0.5 * cruise_radps_ * left_s * left_s / braking_s;
}

double TrapezoidalProfile::velocity_radps(double at_s) const {
  if (at_s >= end_s_) return 0.0;
  if (at_s < cruise_begins_s_) return from_radps_ + (cruise_radps_ - from_radps_) * at_s / cruise_begins_s_;
  if (at_s < cruise_ends_s_) return cruise_radps_;
  return cruise_radps_ * (end_s_ - at_s) / (end_s_ - cruise_ends_s_);
}

JointVector stoppable_radps(const JointLimits& limits, double share, const JointVector& q_rad,
                            const JointVector& qd_radps) {
  JointLimits gentler = limits;
  gentler.acceleration_radps2 *= share;
  const JointVector within_rad = q_rad.cwiseMax(limits.lower_rad).cwiseMin(limits.upper_rad);
  const VelocityRange range = sustainable_range(gentler, within_rad, within_rad, 0.0);
  return qd_radps.cwiseMax(range.lower_radps).cwiseMin(range.upper_radps);
}

/// Between two knots each joint's acceleration is constant, so that the guide's cubics are the profiles.
void append_fastest(const JointLimits& limits, double share, const JointVector& q_rad, Guide& guide) {
  static_assert(1 + 3 * kMaxJoints <= kMaxKnots);
  const double start_s = guide.end_s();
  const JointVector from_rad = guide.position_rad[0], from_radps = guide.velocity_radps[0];
  BoundedList<TrapezoidalProfile, kMaxJoints> profiles;
  BoundedList<double, 3 * kMaxJoints> changes_s;
  for (Eigen::Index i = 0; i < q_rad.size(); ++i) {
    const TrapezoidalProfile profile(q_rad[i] - from_rad[i], from_radps[i], share * limits.velocity_radps[i],
                                     share * limits.acceleration_radps2[i]);
    profiles.add(profile);
    for (const double at_s : {profile.cruise_begins_s(), profile.cruise_ends_s(), profile.end_s()}) changes_s.add(at_s);
  }
  std::sort(changes_s.begin(), changes_s.end());
  const double end_s = std::max(kSameTime_s, changes_s[changes_s.size() - 1]);
  double last_s = 0.0;
  for (const double at_s : changes_s) {
    if (at_s < last_s + kSameTime_s || at_s > end_s - kSameTime_s) continue;
    JointVector way_rad = q_rad, qd_radps = q_rad;
    for (int i = 0; i < profiles.size(); ++i) {
      way_rad[i] = profiles[i].position_rad(at_s);
      qd_radps[i] = profiles[i].velocity_radps(at_s);
    }
    guide.add(start_s + at_s, from_rad + way_rad, qd_radps);
    last_s = at_s;
  }
  guide.add(start_s + end_s, q_rad);
}

}  // namespace sidestep
