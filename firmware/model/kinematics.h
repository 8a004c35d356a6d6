#pragma once

#include <array>
#include <bitset>

#include "firmware/model/arm.h"
#include "firmware/model/attachments.h"

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

/// The shapes that move with the arm are numbered: those of Arm::shapes, then what the tool holds.
inline int shape_count(const Arm& arm, const LinkPoses& poses) {
  const Attachments* attachments = poses.others->attachments;
  return static_cast<int>(arm.shapes.size()) + (attachments ? attachments->held.size() : 0);
}
inline const BodyShape& shape_at(const Arm& arm, const LinkPoses& poses, int index) {
  const int links = static_cast<int>(arm.shapes.size());
  if (index < links) return arm.shapes[static_cast<size_t>(index)];
  return poses.others->attachments->held[index - links];
}

/// The shapes of the bodies up to this one keep clear of an obstacle, those of bodies above may touch it: all bodies
/// keep clear unless Attachments::allowed names the obstacle, then all but the last body, which carries what the tool
/// holds. -1: a held shape has the obstacle's id, so the obstacle is what the tool holds, and no body avoids it.
inline int last_body_to_keep_clear(const Arm& arm, const LinkPoses& poses, int32_t obstacle_id) {
  const Attachments* attachments = poses.others->attachments;
  if (!attachments || !attachments->allows(obstacle_id)) return arm.joints;
  return attachments->holds(obstacle_id) ? -1 : arm.joints - 1;
}

/// Index into LinkPoses of the frame in which a shape is given.
inline int frame_of(const BodyShape& shape) {
  return shape.other_joint < 0 ? shape.body : other_frame(shape.other_joint);
}

/// The capsule around a shape in the base frame.
Capsule transformed(const LinkPoses& poses, const BodyShape& shape);

/// The exact shape in the base frame.
ConvexSolid solid_of(const LinkPoses& poses, const BodyShape& shape);

/// The Jacobian of a body's point p_base (m): its velocity is this, 3 x n, times the joint velocities. The columns of
/// joints beyond the body are 0.
PointJacobian point_jacobian(const LinkPoses& poses, int body, const Vector3& p_base);

/// The velocity of a body's point p_base (m) by these joint velocities, m/s: the Jacobian times them.
Vector3 point_velocity(const LinkPoses& poses, int body, const Vector3& p_base, const JointVector& velocity_radps);

/// The Jacobian of the tool, rows x n, with rows = 3 (linear) or 6 (linear, then angular).
TaskJacobian tool_jacobian(const LinkPoses& poses, int rows);

/// The rotation, in the base frame, that turns the tool to the goal orientation (base_from_goal, a unit quaternion).
/// The orientation error is the vector angle() * axis(), rad, with an angle from 0 to pi. A caller with a gain computes
/// gain * angle() * axis().
Eigen::AngleAxisd orientation_error(const Quaternion& goal, const Matrix3& base_from_tool);

}  // namespace sidestep
