#pragma once

#include "firmware/model/arm.h"

namespace sidestep {

/// Joint velocities that the limits allow for the coming period, n x 1 each.
struct VelocityRange {
  JointVector lower_radps;
  JointVector upper_radps;
};

/// Velocities with which every joint, going on from the velocity last commanded, stays within its velocity and
/// acceleration limits and can still stop before its position limits. Each joint is known to be between two positions
/// (commanded and measured). Never empty: a joint that is past what its limits allow gets the one velocity that returns
/// soonest.
VelocityRange velocity_range(const JointLimits& limits, const JointVector& lowest_rad, const JointVector& highest_rad,
                             const JointVector& last_velocity_radps, double period_s);

/// Velocities that every joint could come to and keep up for a while: its velocity limits, less what it needs to stop
/// before its position limits. As velocity_range() without the accelerations.
VelocityRange sustainable_range(const JointLimits& limits, const JointVector& lowest_rad,
                                const JointVector& highest_rad, double period_s);

/// Largest velocity toward a limit gap_rad away from which the joint can stop within it, one period of travel included.
/// Negative gap: past the limit, velocity back.
double stopping_velocity(double gap_rad, double acceleration_radps2, double period_s);

/// A velocity within the limits: one uniform scale for the velocity limits, which keeps the direction, then each joint
/// into its range (paper-notes item 10). Returns the set of Limiting bits that acted.
int apply_limits(const JointLimits& limits, const VelocityRange& range, const JointVector& last_velocity_radps,
                 double period_s, JointVector& velocity_radps);

/// Slows every joint to rest as fast as its acceleration limit allows, never past zero.
JointVector brake(const JointLimits& limits, const JointVector& last_velocity_radps, double period_s);

}  // namespace sidestep
