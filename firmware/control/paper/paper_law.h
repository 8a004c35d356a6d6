#pragma once

#include "firmware/control/types/law.h"

namespace sidestep {

/// The paper's law before joint limits, eqs (3) to (19) as settled by paper-notes items 1 to 9. `planned_mps` is X of
/// the cycle before, or null when the arm was not tracking; used with tool_velocity: planned.
NominalCommand paper_law(const PaperGains& gains, double period_s, const Situation& situation,
                         const Vector3* planned_mps);

}  // namespace sidestep
