#pragma once

#include <optional>

#include "firmware/control/types/law.h"
#include "firmware/control/types/settings.h"

namespace sidestep {

/// The paper's law before the joint limits: eqs (3) to (19) as settled by docs/paper.md, items 1 to 9. `planned_mps` is
/// the commanded tool velocity X of the previous cycle, absent where that cycle was not tracking; it is used with
/// tool_velocity: planned.
NominalCommand paper_law(const PaperGains& gains, double period_s, const LawInput& input,
                         const std::optional<Vector3>& planned_mps);

}  // namespace sidestep
