#pragma once

#include "firmware/model/arm.h"

namespace sidestep {

/// Bounds of the joint velocities, n x 1 each; lower <= upper.
struct VelocityRange {
  JointVector lower_radps;
  JointVector upper_radps;
};

/// Velocities for the next period with which every joint stays within its velocity and acceleration limits, starting
/// from the last commanded velocity, and can still stop before its position limits. Each joint is known to lie between
/// two positions (commanded and measured). Never empty: a joint that cannot keep its limits gets the one velocity that
/// returns to them soonest.
VelocityRange velocity_range(const JointLimits& limits, const JointVector& lowest_rad, const JointVector& highest_rad,
                             const JointVector& last_velocity_radps, double period_s);

/// Velocities that every joint can sustain: its velocity limits, reduced near the position limits to what can be
/// stopped before them. As velocity_range(), without the acceleration limits.
VelocityRange sustainable_range(const JointLimits& limits, const JointVector& lowest_rad,
                                const JointVector& highest_rad, double period_s);

/// Largest velocity toward a limit at distance gap_rad from which the joint can stop within the gap, one further period
/// of travel included. For a negative gap (past the limit) the velocity points back.
double stopping_velocity(double gap_rad, double acceleration_radps2, double period_s);

}  // namespace sidestep
