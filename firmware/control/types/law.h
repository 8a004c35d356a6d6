#pragma once

#include "firmware/control/types/messages.h"
#include "firmware/control/types/settings.h"
#include "firmware/model/clearance.h"

namespace sidestep {

/// What a law is asked in one cycle.
struct Situation {
  const Arm& arm;
  const LinkPoses& poses;
  const TaskJacobian& tool_jacobian;  ///< of the rows that the target has: 3, or 6 with an orientation
  const JointVector& position_rad;    ///< measured
  const JointVector& velocity_radps;  ///< measured
  const Target& target;               ///< moved forward to the present
  const ObstacleView& obstacles;
  const Clearance& clearance;
};

/// What a law answers.
struct NominalCommand {
  JointVector velocity_radps;
  Vector3 tool_velocity_mps = Vector3::Zero();  ///< X of paper-notes item 4, linear part
  double beta = 0.0;
  double damping = 0.0;
  bool task_speed_limited = false;
};

}  // namespace sidestep
