#include "firmware/foresight/inverse_kinematics.h"

#include "firmware/model/damped_inverse.h"
#include "firmware/model/kinematics.h"

namespace sidestep {
namespace {

constexpr int kMostSteps = 30;
constexpr double kLongestStep_rad = 0.5;
constexpr double kDamping = 0.02;
constexpr double kReached_m = 1e-3;
constexpr double kReached_rad = 1e-2;

/// From the tool to the target: position (m), and orientation (rad) where the target tracks it.
TaskVector task_error(const LinkPoses& poses, const Target& target) {
  TaskVector error(target.tracks_orientation ? 6 : 3);
  error.head<3>() = target.position_m - poses.tool_position;
  if (!target.tracks_orientation) return error;
  const Eigen::AngleAxisd to_goal = orientation_error(target.orientation, poses.tool_rotation);
  error.tail<3>() = to_goal.angle() * to_goal.axis();
  return error;
}

bool is_reached(const TaskVector& error) {
  return error.head<3>().norm() < kReached_m && (error.size() == 3 || error.tail<3>().norm() < kReached_rad);
}

}  // namespace

bool solve_ik(const Arm& arm, const Target& target, JointVector& q_rad) {
  for (int step = 0; step < kMostSteps; ++step) {
    const LinkPoses poses = forward_kinematics(arm, q_rad);
    const TaskVector error = task_error(poses, target);
    if (is_reached(error)) return true;
    TaskJacobian jacobian = tool_jacobian(poses, static_cast<int>(error.size()));
    for (int i = 0; i < arm.joints; ++i) jacobian.col(i) *= arm.joint_scale[i];
    JointVector change_rad = damped_solve(jacobian, kDamping, error);  // in units of the scale
    change_rad *= std::min(1.0, kLongestStep_rad / change_rad.cwiseAbs().maxCoeff());
    q_rad = (q_rad + change_rad.cwiseProduct(arm.joint_scale))
                .cwiseMax(arm.limits.lower_rad)
                .cwiseMin(arm.limits.upper_rad);
  }
  return false;
}

}  // namespace sidestep
