#pragma once

#include "firmware/model/kinematics.h"
#include "firmware/model/obstacle.h"

namespace sidestep {

/// A link shape as an obstacle to other arms, of Shape::kCapsule: its enclosing capsule and its velocity in the base
/// frame. velocity_radps: of the joints, n x 1. The id is 0.
Obstacle link_obstacle(const LinkPoses& poses, const BodyShape& shape, const JointVector& velocity_radps);

}  // namespace sidestep
