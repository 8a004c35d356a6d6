#pragma once

#include "host/campaign/scene.h"

namespace sidestep::campaign {

/// Measures how smooth a stream of joint velocity commands is.
class Smoothness {
 public:
  /// velocity_radps: the last command before the stream.
  explicit Smoothness(const Joints& velocity_radps)
      : velocity_radps_(velocity_radps),
        acceleration_(Joints::Zero(velocity_radps.size())),
        direction_(Joints::Zero(velocity_radps.size())) {}

  /// Adds the next command. Only periods with `near` (an obstacle is close) count for chatter.
  void add(const Joints& velocity_radps, bool near);

  // The largest of any joint.
  double speed_radps() const { return speed_radps_; }
  double acceleration_radps2() const { return acceleration_radps2_; }
  double jerk_radps3() const { return jerk_radps3_; }

  /// Sign changes of a joint's acceleration per second near an obstacle, mean over the joints; NaN without such
  /// periods.
  double chatter_per_s() const;

 private:
  Joints velocity_radps_;
  Joints acceleration_;
  Joints direction_;  ///< sign of each joint's last noticeable acceleration; 0 before the first
  double speed_radps_ = 0.0;
  double acceleration_radps2_ = 0.0;
  double jerk_radps3_ = 0.0;
  int sign_changes_ = 0;
  int near_periods_ = 0;
};

}  // namespace sidestep::campaign
