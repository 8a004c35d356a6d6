#pragma once

#include "firmware/control/types/law.h"

namespace sidestep {

/// The joint velocity, rad/s, n x 1, toward configurations in which the target's twist x takes smaller joint speeds
/// (task compatibility, Chiu 1988): in the null space, down the gradient of
///
///   x^T (D D^T + lambda^2 I)^-1 x / 2,   D = J diag(h)
///
/// with the joint velocity limits h and the rotation's rows of x and J times kTurnWeight_m. It is scaled down where a
/// joint would exceed its velocity limit. Zero for a target that rests, and for a position alone, whose null space is
/// large enough. No allocation.
JointVector toward_task_compatibility(const LawInput& input);

}  // namespace sidestep
