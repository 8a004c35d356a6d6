#pragma once

#include "firmware/control/types/law.h"

namespace sidestep {

/// The joint velocity that leads the joints from their limits, as far as the tool does not notice, n x 1: hardly any
/// within the range, k_posture at a limit.
JointVector away_from_limits(const SidestepGains& gains, const JointLimits& limits, const JointVector& q_rad);

/// Our own law before the shield: the tool straight to the target with the target's own velocity in it, through a
/// damped inverse, and `preferred_radps`, n x 1, in what that leaves free. It knows nothing of obstacles: the shield
/// keeps clear, and repulsion in the wish only costs arrivals (measured by host/campaign).
NominalCommand sidestep_law(const SidestepGains& gains, const Situation& now, const JointVector& preferred_radps);

}  // namespace sidestep
