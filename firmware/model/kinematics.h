#pragma once

#include <array>
#include <bitset>

#include "firmware/model/arm.h"

namespace sidestep {

/// Index into LinkPoses of the frame of a joint outside the chain.
constexpr int other_frame(int other_joint) {
  return kMaxJoints + 1 + other_joint;
}

/// The poses of all bodies of the arm, and of the frames of the joints outside the chain (other_frame()), in one
/// configuration, in the base frame.
struct LinkPoses {
  int joints = 0;                                                  ///< n
  std::bitset<kMaxJoints> prismatic;                               ///< as in Arm
  std::array<Matrix3, kMaxJoints + 1 + kMaxOtherJoints> rotation;  ///< of body i; its z column is the axis of joint i
  std::array<Vector3, kMaxJoints + 1 + kMaxOtherJoints> origin;    ///< of body i, m; lies on the axis of joint i
  const OtherFrames* others = nullptr;                             ///< with which they were computed
  Matrix3 tool_rotation;
  Vector3 tool_position;  ///< m
};

/// Forward kinematics, q_rad n x 1 (rad, or m for a prismatic joint). The tests check it against
/// KDL::ChainFkSolverPos_recursive.
/// The joints outside the chain are at `others`, which must outlive the result.
LinkPoses forward_kinematics(const Arm& arm, const JointVector& q_rad, const OtherFrames& others);

/// The same with the joints outside the chain at Arm::other_positions.
inline LinkPoses forward_kinematics(const Arm& arm, const JointVector& q_rad) {
  return forward_kinematics(arm, q_rad, arm.other_frames);
}

/// Index into LinkPoses of the frame in which a link shape is given.
inline int frame_of(const LinkShape& shape) {
  return shape.other_joint < 0 ? shape.body : other_frame(shape.other_joint);
}

/// The capsule of a link shape in the base frame.
Capsule transformed(const LinkPoses& poses, const LinkShape& shape);

/// The exact shape of a link shape in the base frame.
ConvexSolid solid_of(const LinkPoses& poses, const LinkShape& shape);

/// The Jacobian of a body's point p_base (m): its velocity is this, 3 x n, times the joint velocities. The columns of
/// joints beyond the body are 0.
PointJacobian point_jacobian(const LinkPoses& poses, int body, const Vector3& p_base);

/// The Jacobian of the tool, rows x n, with rows = 3 (linear) or 6 (linear, then angular).
TaskJacobian tool_jacobian(const LinkPoses& poses, int rows);

/// The rotation, in the base frame, that turns the tool to the goal orientation (base_from_goal, a unit quaternion).
/// The orientation error is the vector angle() * axis(), rad, with an angle from 0 to pi. A caller with a gain computes
/// gain * angle() * axis().
Eigen::AngleAxisd orientation_error(const Quaternion& goal, const Matrix3& base_from_tool);

}  // namespace sidestep
