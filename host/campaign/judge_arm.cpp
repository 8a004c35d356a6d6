#include "host/campaign/judge_arm.h"

#include <algorithm>
#include <cmath>

namespace sidestep::campaign {
namespace {

constexpr std::array<double, kJoints> kAlphaSign{0, 1, -1, 1, -1, 1, -1};  // of a quarter turn
constexpr std::array<double, kJoints> kOffset_m{0.3, 0, 0.328, 0, 0.2765, 0, 0};
constexpr double kTool_m = 0.3372;

double distance_to_segment(const Vector3& start, const Vector3& end, const Vector3& p) {
  const Vector3 along = end - start;
  const double share = std::clamp((p - start).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (p - start - share * along).norm();
}

}  // namespace

ArmPose pose(const Joints& q_rad) {
  ArmPose pose;
  Matrix3 rotation = Matrix3::Identity();
  Vector3 origin = Vector3::Zero();
  for (size_t i = 0; i < kJoints; ++i) {
    // Craig: turn by alpha about x, move by d along the new z, turn by q about it.
    if (kAlphaSign[i] != 0.0) {
      const Vector3 y = rotation.col(1);
      rotation.col(1) = kAlphaSign[i] * rotation.col(2);
      rotation.col(2) = -kAlphaSign[i] * y;
    }
    origin += kOffset_m[i] * rotation.col(2);
    const double c = std::cos(q_rad[static_cast<int>(i)]), s = std::sin(q_rad[static_cast<int>(i)]);
    const Vector3 x = rotation.col(0), y = rotation.col(1);
    rotation.col(0) = c * x + s * y;
    rotation.col(1) = c * y - s * x;
    pose.axes[i] = rotation.col(2);
    pose.origins[i] = origin;
  }
  pose.corners = {Vector3::Zero(), pose.origins[0], pose.origins[2], pose.origins[4],
                  origin + kTool_m * rotation.col(2)};
  pose.tool_rotation = rotation;
  return pose;
}

Eigen::Matrix<double, 3, kJoints> tool_jacobian(const ArmPose& pose) {
  Eigen::Matrix<double, 3, kJoints> jacobian;
  for (size_t i = 0; i < kJoints; ++i)
    jacobian.col(static_cast<int>(i)) = pose.axes[i].cross(pose.tool() - pose.origins[i]);
  return jacobian;
}

double clearance(const ArmPose& pose, const Vector3& center_m, double radius_m) {
  double least_m = distance_to_segment(pose.corners[0], pose.corners[1], center_m);
  for (size_t i = 1; i < 4; ++i)
    least_m = std::min(least_m, distance_to_segment(pose.corners[i], pose.corners[i + 1], center_m));
  return least_m - kLinkRadius_m - radius_m;
}

}  // namespace sidestep::campaign
