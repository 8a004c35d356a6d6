#pragma once

#include "firmware/control/guide.h"
#include "firmware/control/law.h"

namespace sidestep {

/// The wish of an arm that follows a guide with at least one knot: along its way, then as the sidestep law with the
/// last knot as the preferred posture, or at rest there when it is a place to wait.
Wish guided_law(const SidestepGains& gains, const Situation& now, const Guide& guide, double now_s);

}  // namespace sidestep
