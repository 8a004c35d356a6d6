#pragma once

#include "firmware/control/shield_qp.h"

namespace sidestep {

/// On which side each link leaves the way of an obstacle. `plan` is the velocity for the sides that the rows name.
/// Where that leads into an obstacle, tries the other sides of the most urgent ways, looks with each at where the arm
/// would really be, and returns the best. Bounded: at most 2^4 QPs and short rollouts, none where the plan is fine.
QpSolution choose_sides(const ShieldSettings& settings, const Surroundings& now, const ShieldRows& rows,
                        const VelocityRange& range, const Nearness& nearness, const QpSolution& plan);

}  // namespace sidestep
