#pragma once

#include "firmware/control/types/messages.h"
#include "firmware/model/clearance.h"
#include "firmware/model/velocity_range.h"

namespace sidestep {

/// The input of a law in one cycle. Everything is in the base frame, at the time of the cycle.
struct LawInput {
  const Arm& arm;
  const LinkPoses& poses;
  const TaskJacobian& tool_jacobian;  ///< 3 x n for a position target, 6 x n for a full pose
  const JointVector& position_rad;    ///< measured
  const JointVector& velocity_radps;  ///< measured
  const Target& target;               ///< extrapolated to the time of the cycle
  const ObstacleView& obstacles;
  const Clearance& clearance;
  const VelocityRange& sustainable;  ///< of the joint velocities, see sustainable_range()
};

/// In a full pose a turn of the tool by 1 rad weighs as much as a way of 0.1 m, about the size of a hand: where joints
/// at their limits or near a singular configuration cannot do both, the tool keeps its position and turns late. Tuned
/// on the campaign's follow6d.
constexpr double kTurnWeight_m = 0.1;

/// The task Jacobian with the rows of the rotation times this weight. Of a position target it is the same.
template <typename Jacobian>
Jacobian weighted_task(const Jacobian& jacobian, double turn_weight_m = kTurnWeight_m) {
  Jacobian weighted = jacobian;
  if (jacobian.rows() == 6) weighted.template bottomRows<3>() *= turn_weight_m;
  return weighted;
}

/// The output of a law: the joint velocity u before the shield.
struct NominalCommand {
  JointVector velocity_radps;
  Vector3 tool_velocity_mps = Vector3::Zero();  ///< commanded tool velocity X (docs/paper.md, item 4), linear part
  double beta = 0.0;                            ///< task priority, paper eq (19); 0 in our own law
  double damping = 0.0;                         ///< lambda, paper eq (6)
  bool task_speed_limited = false;  ///< v_max clipped the tool velocity (in our own law: its part toward the target)
};

}  // namespace sidestep
