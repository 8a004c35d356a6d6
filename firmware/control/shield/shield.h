#pragma once

#include <utility>
#include <vector>

#include "firmware/control/types/law.h"
#include "firmware/model/velocity_range.h"

namespace sidestep {

/// What the shield has to know beside the wish.
struct ShieldInput {
  const Arm& arm;
  const LinkPoses& poses;
  const JointVector& position_rad;
  const JointVector& last_velocity_radps;  ///< commanded
  const Clearance& clearance;
  const ObstacleView& obstacles;
  const std::vector<std::pair<int, int>>& self_pairs;
  const JointVector& evasion_radps;  ///< chosen the cycle before to get out of a way; size 0: none
  double period_s;
  double comfort_weight;  ///< at present, s2/m2
};

/// A joint velocity to come to, and whether it is chosen to get out of an obstacle's way.
struct Evasion {
  JointVector velocity_radps;
  bool evading = false;
};

/// What the shield made of a wish.
struct Shielded {
  JointVector velocity_radps;
  double hard_slack_mps = 0.0;  ///< by how much the worst hard clearance had to be given up, 0 if none
  Evasion plan;
};

/// The joint velocity within `range` that keeps clear and is nearest to the wish. Nearest counts the tool's velocity
/// more than the joints', so that an obstacle is evaded with the rest of the arm where that is possible.
///
/// Three tiers of conditions  row . q' >= bound  on the joint velocity:
///   hard     d' >= -gain (d - clearance), the obstacle's velocity included (a control barrier on the distance), for
///            every pair of a link with an obstacle or with another link; given up only where the limits leave nothing
///            else, and then the worst pair first
///   pass     the closest approach of a moving obstacle stays clear: out of its way, not before it away
///   comfort  a larger distance, as far as it costs the wish little
///
/// First the velocity that the arm shall come to, within `lasting`, what it can keep up; then the step toward it that
/// the accelerations allow in one period, under the hard tier alone.
Shielded shield(const ShieldSettings& settings, const ShieldInput& now, const VelocityRange& sustainable,
                const VelocityRange& range, const TaskJacobian& tool_jacobian, const JointVector& nominal_radps);

}  // namespace sidestep
