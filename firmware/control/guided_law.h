#pragma once

#include "firmware/control/types/guide.h"
#include "firmware/control/types/law.h"
#include "firmware/control/types/settings.h"

namespace sidestep {

/// Nominal velocity of an arm that follows a guide with at least one knot: the guide's joint velocity plus k_guide
/// times the deviation from it. After the last knot: the sidestep law with that knot as the preferred posture; with
/// ForesightStatus::kWaiting the arm stays at the knot instead.
NominalCommand guided_law(const SidestepGains& gains, const LawInput& input, const Guide& guide, double now_s);

}  // namespace sidestep
