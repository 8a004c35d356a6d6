#pragma once

#include "firmware/control/types/guide.h"
#include "firmware/control/types/law.h"

namespace sidestep {

/// The wish of an arm that follows a guide with at least one knot: along its way, then as the sidestep law with the
/// last knot as the preferred posture, or at rest there when it is a place to wait.
NominalCommand guided_law(const SidestepGains& gains, const Situation& now, const Guide& guide, double now_s);

}  // namespace sidestep
