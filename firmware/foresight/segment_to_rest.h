#pragma once

#include "firmware/control/types/guide.h"
#include "firmware/model/arm.h"

namespace sidestep {

/// One joint in a segment of a guide that ends at rest: the cubic (types/guide.h) from the velocity from_radps over
/// displacement_rad in duration_s > 0. Prismatic joints: m, m/s.
struct SegmentToRest {
  double displacement_rad, from_radps, duration_s;

  double largest_velocity_radps() const;       ///< of |velocity|
  double largest_acceleration_radps2() const;  ///< of |acceleration|
  /// Where the joint turns back, from the start, rad; 0 if it does not.
  double turning_rad() const;
};

/// A duration in which all joints keep within `share` of the limits of acceleration and velocity; a joint that starts
/// faster does not exceed its speed. At most 10 % longer than the first such duration; from rest, the shortest with
/// `share` of the limits of velocity and its square of those of acceleration. s
double duration_to_rest_s(const JointLimits& limits, double share, const JointVector& displacement_rad,
                          const JointVector& from_radps);

/// Whether all joints are within their position limits where they turn back in the first segment of a guide, which ends
/// at rest.
bool turns_within_limits(const JointLimits& limits, const Guide& guide);

}  // namespace sidestep
