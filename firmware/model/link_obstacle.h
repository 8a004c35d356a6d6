#pragma once

#include "firmware/model/kinematics.h"
#include "firmware/model/obstacle.h"

namespace sidestep {

/// A shape of the arm as others have to keep clear of it: where it is and how it moves, in the base frame.
/// velocity_radps: n x 1, of the joints.
Obstacle link_obstacle(const LinkPoses& poses, const LinkShape& shape, const JointVector& velocity_radps);

}  // namespace sidestep
