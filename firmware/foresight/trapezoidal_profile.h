#pragma once

#include "firmware/control/types/guide.h"
#include "firmware/model/arm.h"

namespace sidestep {

/// The time-optimal motion of one joint from a velocity to rest elsewhere, within limits of velocity and acceleration:
/// a trapezoidal velocity profile. It accelerates to the cruise velocity, keeps it, and decelerates. A joint that is
/// faster than the limit at the start first brakes to it. Prismatic joints: m, m/s, m/s2.
class TrapezoidalProfile {
 public:
  /// Both limits must be above 0.
  TrapezoidalProfile(double displacement_rad, double from_radps, double velocity_limit_radps,
                     double acceleration_limit_radps2);

  double cruise_begins_s() const { return cruise_begins_s_; }
  double cruise_ends_s() const { return cruise_ends_s_; }
  double end_s() const { return end_s_; }

  /// From the start, at a time of 0 or later.
  double position_rad(double at_s) const;
  double velocity_radps(double at_s) const;

 private:
  double displacement_rad_, from_radps_, cruise_radps_;
  double cruise_begins_s_, cruise_ends_s_, end_s_;
};

/// The velocity of an arm, each joint's limited to its velocity limit and to that from which it stops before its
/// position limits while it decelerates at `share` of its acceleration limit. A joint beyond a limit may only return.
JointVector stoppable_radps(const JointLimits& limits, double share, const JointVector& q_rad,
                            const JointVector& qd_radps);

/// Appends to a guide of one knot the motion from its position and velocity to rest at q_rad, every joint in its own
/// shortest time within `share` of the limits of velocity and acceleration, with knots where an acceleration changes.
/// From a stoppable velocity all joints stay between the position limits if both ends do.
void append_fastest(const JointLimits& limits, double share, const JointVector& q_rad, Guide& guide);

}  // namespace sidestep
