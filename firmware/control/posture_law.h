#pragma once

#include "firmware/control/types/law.h"
#include "firmware/control/types/settings.h"

namespace sidestep {

/// The nominal velocity toward a posture, LawInput::target.posture_rad: a straight line in joint space, on which all
/// joints arrive together. No joint is faster than from where it can stop in time: with its distance d to the posture,
/// the gain k = k_pos and the acceleration a = 90 % of its limit,
///   k d                    for d <= a / k^2
///   sqrt(a (2d - a / k^2)) beyond, at most the joint's velocity limit.
/// The tool is not faster than v_max. Like sidestep_law() the law does not consider obstacles.
NominalCommand posture_law(const SidestepGains& gains, const LawInput& input);

}  // namespace sidestep
