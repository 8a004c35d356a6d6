#pragma once

#include "firmware/control/types/inputs.h"
#include "firmware/control/types/model.h"
#include "firmware/model/clearance.h"
#include "firmware/model/kinematics.h"

namespace sidestep {

/// The newest obstacle set, its age and its growth, together with the surroundings. With the acceleration bound a, the
/// speed bound v and the age t (including the latency), the obstacles of the set grow by the position uncertainty +
/// min(1/2 a t^2, v t). After its timeout they may be anywhere within the uncertainty + v t; the rest of that is the
/// view's possible_m. Surroundings do not grow.
ObstacleView view_obstacles(const Model& model, const Latest<ObstacleSet>& obstacles, double now_s);

/// What hangs on the chain. The joints outside it are at the positions of the newest message, however old, else at
/// Arm::other_positions; their velocities are 0 once the message is older than timeouts.obstacles_s. The tool holds
/// what the newest message tells, however old, which must outlive the result.
OtherFrames present_others(const Model& model, const Inputs& inputs, double now_s);

/// The target dt_s later, at its own linear and angular velocity.
Target extrapolated(const Target& target, double dt_s);

/// Rows of the task: 6 for a target that tracks an orientation, else 3.
inline int target_rows(const Latest<Target>& target) {
  return target.message && target.message->tracks_orientation ? 6 : 3;
}

/// The target with each of its velocities v (linear, angular) scaled down to what the joint velocity limits h permit in
/// this configuration: |v| <= sum_i |n . J_i| h_i, n = v / |v|, J_i the tool Jacobian's column of joint i. No joint
/// velocity within the limits moves the tool faster along n, so a target that the arm can follow is not changed. A
/// larger velocity would only make the shield prefer the target to the clearances. With a Jacobian of 3 rows the
/// angular velocity remains as it is.
Target bounded_speed(const Arm& arm, const TaskJacobian& tool_jacobian, const Target& target);

/// The newest target, extrapolated from its receipt to now_s; its velocities are bounded as above where
/// Settings::bounds_target_speed is set. A posture is clamped to the position limits, and position_m is the tool's
/// place in it. There must be a target. tool_jacobian: target_rows() x n, in the present configuration.
Target present_target(const Model& model, const TaskJacobian& tool_jacobian, const Latest<Target>& latest,
                      double now_s);

}  // namespace sidestep
