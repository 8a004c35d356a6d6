#include "host/campaign/judge_arm.h"

#include <algorithm>
#include <cmath>

#include "firmware/model/kinematics.h"
#include "host/campaign/family.h"
#include "host/campaign/lwa3_arm.h"
#include "host/campaign/urdf_arm.h"

namespace sidestep::campaign {

namespace {

constexpr double kSame = 1e-6;  // m, rad, rad/s, rad/s2

bool same(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return a.size() == b.size() && (a - b).cwiseAbs().maxCoeff() < kSame;
}

bool same_limits(const Limits& a, const Limits& b) {
  return same(a.lower_rad, b.lower_rad) && same(a.upper_rad, b.upper_rad) && same(a.velocity_radps, b.velocity_radps) &&
         same(a.acceleration_radps2, b.acceleration_radps2);
}

/// Whether the capsule is the link of the benchmark's arm between these two corners.
bool is_link(const Capsule& capsule, const Vector3& from, const Vector3& to) {
  const bool forth = same(capsule.start, from) && same(capsule.end, to);
  const bool back = same(capsule.start, to) && same(capsule.end, from);
  return (forth || back) && std::abs(capsule.radius_m - kLinkRadius_m) < kSame;
}

/// Whether the arm is the benchmark's: it compares tool position and all shapes at one configuration, and the limits
/// with those of the families.
bool is_lwa3(const Arm& arm, const JudgeArm& lwa3) {
  Joints q_rad(7);
  q_rad << 0.3, -0.5, 0.7, 0.9, -1.1, 0.6, 0.2;
  if (arm.joints != q_rad.size()) return false;
  const LinkPoses poses = forward_kinematics(arm, q_rad);
  const std::vector<Vector3> corners = lwa3.pose(q_rad).corners;
  if (!same(poses.tool_position, corners.back()) || arm.shapes.size() + 1 != corners.size()) return false;
  for (size_t i = 0; i < arm.shapes.size(); ++i)
    if (!is_link(transformed(poses, arm.shapes[i]), corners[i], corners[i + 1])) return false;
  return std::any_of(families().begin(), families().end(),
                     [&](const Family& family) { return same_limits(arm.limits, lwa3.limits(family)); });
}

}  // namespace

std::unique_ptr<JudgeArm> judge_arm_of(const Config& config) {
  if (!config.model.surroundings.empty())
    throw std::runtime_error("surroundings: must be empty: the benchmark's witness and judge ignore them");
  auto lwa3 = std::make_unique<Lwa3Arm>();
  if (is_lwa3(config.model.arm, *lwa3)) return lwa3;
  return std::make_unique<UrdfArm>(config);
}

ToolJacobian tool_jacobian(const ArmPose& pose) {
  ToolJacobian jacobian(3, pose.axes.size());
  for (size_t i = 0; i < pose.axes.size(); ++i)
    jacobian.col(static_cast<int>(i)) =
        pose.is_prismatic(i) ? pose.axes[i] : pose.axes[i].cross(pose.tool() - pose.origins[i]);
  return jacobian;
}

Vector3 tool_angular_velocity(const ArmPose& pose, const Joints& qd_radps) {
  Vector3 turn_radps = Vector3::Zero();
  for (size_t i = 0; i < pose.axes.size(); ++i)
    if (!pose.is_prismatic(i)) turn_radps += qd_radps[static_cast<int>(i)] * pose.axes[i];
  return turn_radps;
}

}  // namespace sidestep::campaign
