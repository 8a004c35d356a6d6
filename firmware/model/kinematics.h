#pragma once

#include <array>

#include "firmware/model/arm.h"

namespace sidestep {

/// The poses of all bodies of the arm in one configuration, in the base frame.
struct LinkPoses {
  int joints = 0;                                ///< n
  std::array<Matrix3, kMaxJoints + 1> rotation;  ///< of body i; its z column is the axis of joint i
  std::array<Vector3, kMaxJoints + 1> origin;    ///< of body i, m; lies on the axis of joint i
  Matrix3 tool_rotation;
  Vector3 tool_position;  ///< m
};

/// Forward kinematics, q_rad n x 1. The tests check it against KDL::ChainFkSolverPos_recursive.
LinkPoses forward_kinematics(const Arm& arm, const JointVector& q_rad);

/// The capsule of a link shape in the base frame.
Capsule transformed(const LinkPoses& poses, const LinkShape& shape);

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
