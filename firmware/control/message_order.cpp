#include "firmware/control/message_order.h"

#include <algorithm>
#include <cmath>

namespace sidestep {
namespace {

// Beyond anything an arm or its surroundings do; larger numbers are garbage, not measurements.
constexpr double kLargestLength_m = 1000.0;
constexpr double kLargestSpeed_mps = 1000.0;
constexpr double kLargestRate_radps = 1000.0;
constexpr double kLargestJoint_rad = 1000.0;

template <typename Vector>
bool within(const Vector& vector, double bound) {
  return vector.allFinite() && vector.cwiseAbs().maxCoeff() <= bound;
}

}  // namespace

bool plausible(const ArmState& state, int joints) {
  return state.position_rad.size() == joints && state.velocity_radps.size() == joints &&
         within(state.position_rad, kLargestJoint_rad) && within(state.velocity_radps, kLargestRate_radps);
}

bool plausible(const Target& target) {
  const bool finite = target.orientation.coeffs().allFinite() && target.angular_velocity_radps.allFinite();
  const bool rotated = !target.tracks_orientation || (std::abs(target.orientation.norm() - 1.0) < 1e-3 &&
                                                      within(target.angular_velocity_radps, kLargestRate_radps));
  return finite && rotated && within(target.position_m, kLargestLength_m) &&
         within(target.velocity_mps, kLargestSpeed_mps);
}

bool plausible(const Obstacle& obstacle) {
  const Capsule& capsule = obstacle.capsule;
  return within(capsule.start, kLargestLength_m) && within(capsule.end, kLargestLength_m) && capsule.radius_m >= 0.0 &&
         capsule.radius_m <= kLargestLength_m && within(obstacle.half_width_m, kLargestLength_m) &&
         obstacle.half_height_m >= 0.0 && obstacle.half_height_m <= kLargestLength_m &&
         within(obstacle.velocity_mps, kLargestSpeed_mps) &&
         within(obstacle.angular_velocity_radps, kLargestRate_radps);
}

double sent_apart_s(int64_t utime, int64_t later_utime, double received_apart_s, double slack_s) {
  const double apart_s = 1e-6 * (static_cast<double>(later_utime) - static_cast<double>(utime));
  return std::min(apart_s, received_apart_s + slack_s);
}

bool Order::starts_anew(int64_t utime, double now_s, double restart_s) {
  const bool silent = std::abs(now_s - accepted_s_) > restart_s;  // or the clock was set back
  if (silent) return utime != utime_;
  const bool far_back = static_cast<double>(utime_) - static_cast<double>(utime) > restart_s * 1e6;
  if (!far_back) return false;
  anew_in_a_row_ = anew_in_a_row_ > 0 && utime > anew_utime_ ? anew_in_a_row_ + 1 : 1;
  anew_utime_ = utime;
  return anew_in_a_row_ == kAnewInARow;
}

bool Order::accept(int64_t utime, double now_s, double restart_s) {
  if (any_ && utime <= utime_ && !starts_anew(utime, now_s, restart_s)) return false;
  const double by_receipt_s = std::abs(now_s - accepted_s_);
  elapsed_s_ = any_ ? std::max(by_receipt_s, sent_apart_s(utime_, utime, by_receipt_s, restart_s)) : 0.0;
  any_ = true;
  anew_in_a_row_ = 0;
  utime_ = utime;
  accepted_s_ = now_s;
  return true;
}

}  // namespace sidestep
