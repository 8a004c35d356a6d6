#pragma once

#include "firmware/control/cycle.h"

namespace sidestep {

/// Compares the inputs with the clock, and the arm state with the one before; keeps in `next` what the following cycle
/// compares with. Arm states are consistent when none is missing for long, their utime advances and no joint moves
/// farther than its velocity limit allows.
InputStatus monitor_inputs(const Model& model, const Inputs& inputs, double now_s, State& next);

}  // namespace sidestep
