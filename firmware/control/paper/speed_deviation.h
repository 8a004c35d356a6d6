#pragma once

#include "firmware/control/paper/damped_inverse.h"
#include "firmware/model/clearance.h"

namespace sidestep {

/// Share of the largest deviation speed, 0 to 1, at axis distance d_0. Paper eq (17), clamped (docs/paper.md item 7).
double deviation_share(const PaperGains& gains, double d_0_m);

/// Priority of the avoidance task over the tool's, 0 to 1. Paper eq (19) in the general form of docs/paper.md item 8.
double task_priority(const PaperGains& gains, double d_0_m);

/// beta (J_0 N)^+ (X_0 - J_0 q'_task): the second term of paper eq (18), joint velocity n x 1. `nearest` is A_0 with
/// its obstacle; task_velocity is J* X.
JointVector speed_deviation(const PaperGains& gains, const Arm& arm, const LinkPoses& poses, const Proximity& nearest,
                            const TaskInverse& inverse, const JointVector& task_velocity_radps);

}  // namespace sidestep
