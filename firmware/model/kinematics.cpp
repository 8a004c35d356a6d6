#include "firmware/model/kinematics.h"

#include <cmath>

namespace sidestep {
namespace {

/// rotation * v by columns, which is inlined; Eigen's product of small matrices is a function call.
EIGEN_ALWAYS_INLINE Vector3 rotated(const Matrix3& rotation, const Vector3& v) {
  return rotation.col(0) * v[0] + rotation.col(1) * v[1] + rotation.col(2) * v[2];
}

/// The velocity of a point, fixed to body i or a later one, by joint i at unit velocity.
EIGEN_ALWAYS_INLINE Vector3 point_column(const LinkPoses& poses, int i, const Vector3& p_base) {
  const Vector3 axis = poses.rotation[i].col(2);
  return poses.prismatic[i - 1] ? axis : axis.cross(p_base - poses.origin[i]);
}

}  // namespace

LinkPoses forward_kinematics(const Arm& arm, const JointVector& q_rad, const OtherFrames& others) {
  LinkPoses poses;
  poses.joints = arm.joints;
  poses.prismatic = arm.prismatic;
  poses.rotation[0].setIdentity();
  poses.origin[0].setZero();
  for (int i = 1; i <= arm.joints; ++i) {
    const Eigen::Isometry3d& placement = arm.joint_placement[i];
    const Matrix3& parent = poses.rotation[i - 1];
    const Vector3 x = rotated(parent, placement.linear().col(0)), y = rotated(parent, placement.linear().col(1));
    const Vector3 axis = rotated(parent, placement.linear().col(2));
    const double q = q_rad[i - 1];
    poses.origin[i] = poses.origin[i - 1] + rotated(parent, placement.translation());
    poses.rotation[i].col(2) = axis;
    if (arm.prismatic[i - 1]) {
      poses.rotation[i].col(0) = x;
      poses.rotation[i].col(1) = y;
      poses.origin[i] += q * axis;
      continue;
    }
    const double c = std::cos(q), s = std::sin(q);
    poses.rotation[i].col(0) = c * x + s * y;
    poses.rotation[i].col(1) = c * y - s * x;
  }
  poses.others = &others;
  for (int j = 0; j < others.joints.size(); ++j) {
    const int frame = other_frame(j), body = arm.other_joints[static_cast<size_t>(j)].body;
    for (int axis = 0; axis < 3; ++axis)
      poses.rotation[frame].col(axis) = rotated(poses.rotation[body], others.joints[j].rotation.col(axis));
    poses.origin[frame] = poses.origin[body] + rotated(poses.rotation[body], others.joints[j].origin);
  }
  const Matrix3& last = poses.rotation[arm.joints];
  for (int axis = 0; axis < 3; ++axis)
    poses.tool_rotation.col(axis) = rotated(last, arm.last_body_from_tool.linear().col(axis));
  poses.tool_position = poses.origin[arm.joints] + rotated(last, arm.last_body_from_tool.translation());
  return poses;
}

Capsule transformed(const LinkPoses& poses, const BodyShape& shape) {
  const int frame = frame_of(shape);
  const Matrix3& rotation = poses.rotation[frame];
  const Vector3& origin = poses.origin[frame];
  const Capsule& capsule = shape.capsule_body;
  return {origin + rotated(rotation, capsule.start), origin + rotated(rotation, capsule.end), capsule.radius_m};
}

ConvexSolid solid_of(const LinkPoses& poses, const BodyShape& shape) {
  if (shape.is_capsule) return ConvexSolid::of(transformed(poses, shape));
  const int frame = frame_of(shape);
  const Matrix3& rotation = poses.rotation[frame];
  ConvexSolid solid = shape.solid;
  for (int axis = 0; axis < 3; ++axis) solid.rotation.col(axis) = rotated(rotation, shape.solid.rotation.col(axis));
  solid.centre = poses.origin[frame] + rotated(rotation, shape.solid.centre);
  return solid;
}

PointJacobian point_jacobian(const LinkPoses& poses, int body, const Vector3& p_base) {
  PointJacobian jacobian = PointJacobian::Zero(3, poses.joints);
  for (int i = 1; i <= body; ++i) jacobian.col(i - 1) = point_column(poses, i, p_base);
  return jacobian;
}

Vector3 point_velocity(const LinkPoses& poses, int body, const Vector3& p_base, const JointVector& velocity_radps) {
  Vector3 sum_mps = Vector3::Zero();
  for (int i = 1; i <= body; ++i) sum_mps += point_column(poses, i, p_base) * velocity_radps[i - 1];
  return sum_mps;
}

TaskJacobian tool_jacobian(const LinkPoses& poses, int rows) {
  TaskJacobian jacobian(rows, poses.joints);
  jacobian.topRows<3>() = point_jacobian(poses, poses.joints, poses.tool_position);
  if (rows == 6)
    for (int i = 1; i <= poses.joints; ++i)
      jacobian.col(i - 1).tail<3>() = poses.prismatic[i - 1] ? Vector3::Zero() : Vector3(poses.rotation[i].col(2));
  return jacobian;
}

Eigen::AngleAxisd orientation_error(const Quaternion& goal, const Matrix3& base_from_tool) {
  return Eigen::AngleAxisd(goal.toRotationMatrix() * base_from_tool.transpose());
}

}  // namespace sidestep
