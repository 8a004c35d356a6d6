#pragma once

#include "firmware/control/types/messages.h"
#include "firmware/model/arm.h"

namespace sidestep {

/// Inverse kinematics by damped Newton steps, at most 30 of at most 0.5 rad (0.125 m) per joint, from the start
/// configuration q_rad (n x 1), each clamped to the position limits. Returns true, with the solution in q_rad, as soon
/// as the tool is within 1 mm of the target's position and, where the target tracks orientation, within 0.01 rad of its
/// orientation; false, with an arbitrary q_rad, if the steps do not converge.
bool solve_ik(const Arm& arm, const Target& target, JointVector& q_rad);

}  // namespace sidestep
