#pragma once

#include "firmware/model/arm.h"

namespace sidestep {

/// A range of joint velocities, n x 1 each; lower <= upper.
struct VelocityRange {
  JointVector lower_radps;
  JointVector upper_radps;
};

/// The velocities with which each joint stays within its velocity limit, differs from the last commanded velocity by at
/// most acceleration limit x period, and can still stop before its position limits. Each joint is somewhere between two
/// positions, lowest_rad and highest_rad (commanded and measured). Never empty: a joint that cannot meet all limits
/// gets the one velocity that the acceleration limit allows and that returns it soonest.
VelocityRange velocity_range(const JointLimits& limits, const JointVector& lowest_rad, const JointVector& highest_rad,
                             const JointVector& last_velocity_radps, double period_s);

/// The sustainable range: as velocity_range(), without the limit on the change from the last velocity. It holds the
/// velocities that the joints can reach and keep: velocity limits, and stopping before the position limits.
VelocityRange sustainable_range(const JointLimits& limits, const JointVector& lowest_rad,
                                const JointVector& highest_rad, double period_s);

/// The time that the arm takes to stop, all joints braking at their acceleration limits, s.
double stopping_time_s(const JointLimits& limits, const JointVector& velocity_radps);

/// The largest speed v toward a position limit with which the joint can still stop at the limit: one more period at v,
/// then braking at the acceleration a, covers the gap, v T + v^2 / (2 a) = gap. gap_rad is the distance to the limit,
/// positive before it, for the lower limit as for the upper one. A joint past the limit has a negative gap; then v is
/// negative too, |v| being the speed of its return. Infinite for an infinite gap.
double stopping_velocity(double gap_rad, double acceleration_radps2, double period_s);

}  // namespace sidestep
