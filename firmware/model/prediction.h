#pragma once

#include "firmware/model/kinematics.h"
#include "firmware/model/obstacle.h"

namespace sidestep {

/// Least surface distance of the links that can move, at one posture, to `count` obstacles after_s later at constant
/// velocity, m. Not more than enough_m: beyond that it is not looked at closely.
double clearance_after(const Arm& arm, const LinkPoses& poses, const Obstacle* obstacles, int count, double after_s,
                       double enough_m);

}  // namespace sidestep
