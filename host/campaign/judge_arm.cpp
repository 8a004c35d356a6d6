#include "host/campaign/judge_arm.h"

#include "firmware/model/kinematics.h"
#include "host/campaign/lwa3_arm.h"
#include "host/campaign/urdf_arm.h"

namespace sidestep::campaign {

std::unique_ptr<JudgeArm> judge_arm_of(const Config& config) {
  constexpr double kSame_m = 1e-6;
  auto lwa3 = std::make_unique<Lwa3Arm>();
  Joints q_rad(7);
  q_rad << 0.3, -0.5, 0.7, 0.9, -1.1, 0.6, 0.2;
  const Arm& arm = config.model.arm;
  if (arm.joints == q_rad.size() && (forward(arm, q_rad).tool_position - lwa3->pose(q_rad).tool()).norm() < kSame_m)
    return lwa3;
  return std::make_unique<UrdfArm>(config);
}

ToolJacobian tool_jacobian(const ArmPose& pose) {
  ToolJacobian jacobian(3, pose.axes.size());
  for (size_t i = 0; i < pose.axes.size(); ++i)
    jacobian.col(static_cast<int>(i)) = pose.axes[i].cross(pose.tool() - pose.origins[i]);
  return jacobian;
}

Vector3 tool_radps(const ArmPose& pose, const Joints& qd_radps) {
  Vector3 turn_radps = Vector3::Zero();
  for (size_t i = 0; i < pose.axes.size(); ++i) turn_radps += qd_radps[static_cast<int>(i)] * pose.axes[i];
  return turn_radps;
}

}  // namespace sidestep::campaign
