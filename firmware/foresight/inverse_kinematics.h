#pragma once

#include "firmware/control/types/messages.h"
#include "firmware/model/arm.h"

namespace sidestep {

/// Moves a posture, n x 1, to one within the joint limits that has the target, by damped Newton steps. False where they
/// do not lead there.
bool solve_ik(const Arm& arm, const Target& target, JointVector& q_rad);

}  // namespace sidestep
