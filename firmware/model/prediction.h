#pragma once

#include <cmath>

#include "firmware/model/kinematics.h"
#include "firmware/model/obstacle.h"

namespace sidestep {

/// The least surface distance, m, between the moving links in one configuration, with what the tool holds, and `count`
/// obstacles extrapolated by after_s. Allowed contacts (Attachments) do not count. Exact below enough_m; else enough_m
/// is returned, without the exact computation. Where allowance_m is not null, obstacle i counts as farther away by
/// allowance_m[i]. Persons are extrapolated by at most person_coast_s.
double clearance_after(const Arm& arm, const LinkPoses& poses, const Obstacle* obstacles, int count, double after_s,
                       double enough_m, const double* allowance_m = nullptr, double person_coast_s = HUGE_VAL);

}  // namespace sidestep
