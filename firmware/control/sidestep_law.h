#pragma once

#include "firmware/control/types/law.h"
#include "firmware/control/types/settings.h"

namespace sidestep {

/// Joint velocities away from the position limits, rad/s, n x 1: -k_posture r^3, where r runs from -1 to 1 between the
/// limits of the joint; times 0.25 m/rad for a prismatic joint. The cube keeps it small within the range. 0 for a joint
/// without limits. For a full pose, whose null space has three dimensions less, -4 k_posture r |r|.
JointVector away_from_limits(const SidestepGains& gains, const LawInput& input);

/// Our own law: the tool moves straight toward the target, at the target's velocity plus k_pos times the distance
/// (clipped to v_max), through a damped inverse of the tool Jacobian in which 0.25 m/s of a prismatic joint weigh as
/// much as 1 rad/s (Arm::joint_scale). `preferred_radps`, n x 1, acts in the null space. Of a full pose the rotation
/// has the weight kTurnWeight_m, and where that inverse takes a joint beyond LawInput::sustainable, the joint
/// velocities within it that follow the pose best, the position first, replace its result: the other joints make up for
/// a joint at its limit, as far as they can. The law does not consider obstacles; the shield does. Repulsion here was
/// tried on the random scenes of host/campaign, which all have a solution: it only lowered the share of arrivals.
NominalCommand sidestep_law(const SidestepGains& gains, const LawInput& input, const JointVector& preferred_radps);

}  // namespace sidestep
