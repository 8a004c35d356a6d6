#pragma once

#include "firmware/control/law.h"

namespace sidestep {

/// Our own law before the shield: the tool straight to the target with the target's own velocity in it, through a
/// damped inverse. It knows nothing of obstacles: the shield keeps clear, and repulsion in the wish only costs arrivals
/// (measured by host/campaign).
Wish sidestep_law(const SidestepGains& gains, const Situation& now);

}  // namespace sidestep
