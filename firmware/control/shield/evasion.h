#pragma once

#include "firmware/control/shield/shield_qp.h"

namespace sidestep {

/// The way out of the obstacles' ways. `plan_radps` meets the rows, which know one side of every way and what is
/// linear. Looks with it and with other velocities at where the arm would really be: every side of the most urgent
/// ways, each joint alone as fast as it can, and what was chosen the cycle before, which the others have to be clearly
/// better than, or the arm would dither between two. Bounded: at most 15 QPs and 18 + 2 n short rollouts for n
/// joints; none where the plan will do.
Evasion evade(const ShieldSettings& settings, const ShieldInput& now, const ConstraintRows& rows,
              const VelocityRange& range, const QpObjective& objective, const JointVector& plan_radps);

}  // namespace sidestep
