#pragma once

#include "firmware/model/kinematics.h"
#include "firmware/model/obstacle.h"

namespace sidestep {

/// For how long a person is assumed to keep its velocity: limbs swing and turn back, and what a camera takes for the
/// velocity of one at rest is noise.
constexpr double kPersonCoast_s = 0.3;

/// Until when a person is assumed to keep its mean velocity after that.
constexpr double kPersonWalk_s = 2.0;

/// The obstacle after_s later: it keeps its velocity, a person for kPersonCoast_s. A person then keeps its mean
/// velocity until kPersonWalk_s, does not turn, and rests.
Obstacle predicted_obstacle(const Obstacle& obstacle, double after_s);

/// Takes an obstacle through the same motion in small steps: by dt_s, to after_s from the beginning.
void advance(Obstacle& obstacle, double dt_s, double after_s);

/// The least surface distance, m, between the moving links in one configuration, with what the tool holds, and `count`
/// obstacles extrapolated by after_s; persons are predicted_obstacle() if predicts_persons. Allowed contacts
/// (Attachments) do not count. Exact below enough_m; else enough_m is returned, without the exact computation. Where
/// allowance_m is not null, obstacle i counts as farther away by allowance_m[i].
double clearance_after(const Arm& arm, const LinkPoses& poses, const Obstacle* obstacles, int count, double after_s,
                       double enough_m, const double* allowance_m = nullptr, bool predicts_persons = false);

}  // namespace sidestep
