#pragma once

#include <functional>
#include <limits>

#include "firmware/base/bounded_list.h"
#include "firmware/control/types/guide.h"
#include "firmware/model/arm.h"

namespace sidestep {

/// A polyline of configurations.
using JointPath = BoundedList<JointVector, 64>;

/// Whether the arm may be at a configuration.
using IsFree = std::function<bool(const JointVector& q_rad)>;

/// The fastest motion from rest to rest along a polyline of configurations, starting at start_s, with corners that are
/// blended. Velocity and acceleration stay within `share` of the limits; both are piecewise constant along the way.
///
/// A corner is replaced by the parabola that touches both of its sides at the same distance, at most 0.4 rad and 0.45
/// of the shorter side. The distance is halved while the parabola is not free, up to five times; then the arm stops at
/// the corner. Lengths are norms of joint positions divided by Arm::joint_scale.
///
/// On the sides the tool moves no faster than fastest_mps, as sampled at 17 points of each.
///
/// Without knots if they are too many for a guide.
Guide timed_guide(const Arm& arm, const JointPath& path_rad, double share, double start_s, const IsFree& is_free,
                  double fastest_mps = std::numeric_limits<double>::infinity());

}  // namespace sidestep
