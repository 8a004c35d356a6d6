#pragma once

#include <array>

#include "firmware/model/arm.h"

namespace sidestep {

/// Where every body of the arm is at one joint position. Frames are expressed in the base frame.
struct LinkPoses {
  int joints = 0;
  std::array<Matrix3, kMaxJoints + 1> rotation;  ///< of body i; its z column is the axis of joint i
  std::array<Vector3, kMaxJoints + 1> origin;    ///< of body i, m; lies on the axis of joint i
  Matrix3 tool_rotation;
  Vector3 tool_position;  ///< m
};

/// Forward kinematics, q_rad n x 1. Held to KDL::ChainFkSolverPos_recursive by the tests.
LinkPoses forward_kinematics(const Arm& arm, const JointVector& q_rad);

/// A capsule of the arm, in the base frame.
Capsule transformed(const LinkPoses& poses, const LinkShape& shape);

/// Velocity of the point p_base (m) of a body over the joint velocities: 3 x n; columns of joints behind the body are
/// 0.
PointJacobian point_jacobian(const LinkPoses& poses, int body, const Vector3& p_base);

/// Velocity of the tool over the joint velocities: rows = 3 (linear) or 6 (linear, then angular); rows x n.
TaskJacobian tool_jacobian(const LinkPoses& poses, int rows);

}  // namespace sidestep
