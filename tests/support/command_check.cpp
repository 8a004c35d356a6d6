#include "tests/support/command_check.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace sidestep::test {
namespace {

constexpr double kRounding = 1e-9;

/// How far p is outside the range; 0 inside.
double outside(double p, double lower, double upper) {
  return std::max({0.0, lower - p, p - upper});
}

}  // namespace

void CommandCheck::report(const char* what, int joint, double value, double bound) {
  if (!violation_.empty()) return;
  char text[200];
  std::snprintf(text, sizeof text, "command %ld, joint %d: %s %.12g, allowed %.12g", static_cast<long>(fed_), joint + 1,
                what, value, bound);
  violation_ = text;
}

void CommandCheck::begin(const JointVector& position_rad, const JointVector& velocity_radps) {
  position_rad_ = position_rad;
  velocity_radps_ = rate_radps_ = velocity_radps;
}

void CommandCheck::feed(const JointVector& position_rad, const JointVector& velocity_radps) {
  ++fed_;
  const auto joints = static_cast<int>(limits_.velocity_radps.size());
  if (position_rad.size() != joints || velocity_radps.size() != joints)
    return report("number of joints", 0, static_cast<double>(position_rad.size()), joints);
  for (int i = 0; i < joints; ++i) {
    const double p = position_rad[i], v = velocity_radps[i], p_last = position_rad_[i], v_last = velocity_radps_[i];
    if (!std::isfinite(p) || !std::isfinite(v)) return report("a value that is not finite", i, p + v, 0);
    const double v_max = limits_.velocity_radps[i], dv_max = limits_.acceleration_radps2[i] * period_s_;
    if (std::abs(v) > v_max + kRounding) report("velocity", i, v, v_max);
    if (std::abs(v - v_last) > dv_max + kRounding) report("velocity changes by", i, v - v_last, dv_max);
    if (std::abs(p - p_last) > v_max * period_s_ + kRounding)
      report("position jumps by", i, p - p_last, v_max * period_s_);
    const double rate = (p - p_last) / period_s_, rate_last = rate_radps_[i];
    if (std::abs(rate - rate_last) > dv_max + kRounding / period_s_)
      report("position's rate changes by", i, rate - rate_last, dv_max);
    const double expected = p_last + v * period_s_;
    if (!position_correction_allowed_ && std::abs(p - expected) > kRounding)
      report("position is not the one that the velocity leads to:", i, p, expected);
    const double out = outside(p, limits_.lower_rad[i], limits_.upper_rad[i]);
    const double out_last = outside(p_last, limits_.lower_rad[i], limits_.upper_rad[i]);
    if (out > out_last + kRounding) report("farther outside the position limits:", i, out, out_last);
  }
  rate_radps_ = (position_rad - position_rad_) / period_s_;
  position_rad_ = position_rad;
  velocity_radps_ = velocity_radps;
}

void CommandCheck::end() {
  for (int i = 0; i < velocity_radps_.size(); ++i)
    if (velocity_radps_[i] != 0.0) report("the stream ends in motion:", i, velocity_radps_[i], 0);
}

}  // namespace sidestep::test
