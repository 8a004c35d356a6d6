#pragma once

#include <Eigen/Dense>
#include <array>

namespace sidestep::campaign {

constexpr int kJoints = 7;
using Joints = Eigen::Matrix<double, kJoints, 1>;
using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;

constexpr double kLinkRadius_m = 0.05;

/// The benchmark's arm as the judge sees it: the LWA3 from its modified (Craig) D-H table, seven joints, four capsules.
/// Shares nothing with the controller's model, so that an error there cannot hide itself. Base frame, m.
struct ArmPose {
  std::array<Vector3, 5> corners;  ///< foot, shoulder, elbow, wrist, tool: capsule i spans corners i and i + 1
  Matrix3 tool_rotation;
  std::array<Vector3, kJoints> axes;     ///< unit, of each joint
  std::array<Vector3, kJoints> origins;  ///< a point of each joint's axis

  const Vector3& tool() const { return corners[4]; }
};

/// Paper Table 1 with the lengths of paper-notes.md, "The arm".
ArmPose pose(const Joints& q_rad);

/// Velocity of the tool over the joint velocities.
Eigen::Matrix<double, 3, kJoints> tool_jacobian(const ArmPose& pose);

/// Least distance between the arm's surface, base column included, and a sphere's; negative when they overlap.
double clearance(const ArmPose& pose, const Vector3& center_m, double radius_m);

}  // namespace sidestep::campaign
