#include "host/campaign/smoothness.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sidestep::campaign {
namespace {

constexpr double kNoticeable_radps2 = 0.1;  // one percent of the joints' acceleration limit

}  // namespace

void Smoothness::add(const Joints& velocity_radps, bool near) {
  const Joints acceleration = (velocity_radps - velocity_radps_) / kPeriod_s;
  const Joints jerk = (acceleration - acceleration_) / kPeriod_s;
  speed_radps_ = std::max(speed_radps_, velocity_radps.cwiseAbs().maxCoeff());
  acceleration_radps2_ = std::max(acceleration_radps2_, acceleration.cwiseAbs().maxCoeff());
  jerk_radps3_ = std::max(jerk_radps3_, jerk.cwiseAbs().maxCoeff());
  for (int i = 0; i < direction_.size(); ++i) {
    if (std::abs(acceleration[i]) < kNoticeable_radps2) continue;
    const double direction = std::copysign(1.0, acceleration[i]);
    if (near && direction_[i] * direction < 0.0) ++sign_changes_;
    direction_[i] = direction;
  }
  if (near) ++near_periods_;
  velocity_radps_ = velocity_radps;
  acceleration_ = acceleration;
}

double Smoothness::chatter_per_s() const {
  if (near_periods_ == 0) return std::numeric_limits<double>::quiet_NaN();
  return sign_changes_ / (static_cast<double>(direction_.size()) * near_periods_ * kPeriod_s);
}

}  // namespace sidestep::campaign
