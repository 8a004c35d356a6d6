#pragma once

#include "host/campaign/scene.h"

namespace sidestep::campaign {

/// How smooth a stream of joint velocity commands is.
class Smoothness {
 public:
  /// This velocity was commanded before the first.
  explicit Smoothness(const Joints& velocity_radps)
      : velocity_radps_(velocity_radps),
        acceleration_(Joints::Zero(velocity_radps.size())),
        direction_(Joints::Zero(velocity_radps.size())) {}

  /// The next command; `near` tells whether an obstacle is close enough for chatter to matter.
  void add(const Joints& velocity_radps, bool near);

  double speed_radps() const { return speed_radps_; }                  ///< largest of a joint
  double acceleration_radps2() const { return acceleration_radps2_; }  ///< likewise
  double jerk_radps3() const { return jerk_radps3_; }                  ///< likewise

  /// Sign changes of a joint's acceleration per second near an obstacle, mean over the joints; NaN if never near.
  double chatter_per_s() const;

 private:
  Joints velocity_radps_;
  Joints acceleration_;
  Joints direction_;  ///< sign of the last acceleration that was no rounding error
  double speed_radps_ = 0.0;
  double acceleration_radps2_ = 0.0;
  double jerk_radps3_ = 0.0;
  int sign_changes_ = 0;
  int near_periods_ = 0;
};

}  // namespace sidestep::campaign
