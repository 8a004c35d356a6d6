#include "firmware/model/kinematics.h"

#include <cmath>

namespace sidestep {
namespace {

/// rotation * v by columns; Eigen's product of small matrices makes calls.
EIGEN_ALWAYS_INLINE Vector3 turned(const Matrix3& rotation, const Vector3& v) {
  return rotation.col(0) * v[0] + rotation.col(1) * v[1] + rotation.col(2) * v[2];
}

}  // namespace

Posture forward(const Arm& arm, const JointVector& q_rad) {
  Posture posture;
  posture.joints = arm.joints;
  posture.rotation[0].setIdentity();
  posture.origin[0].setZero();
  for (int i = 1; i <= arm.joints; ++i) {
    const Eigen::Isometry3d& placement = arm.joint_placement[i];
    const Matrix3& parent = posture.rotation[i - 1];
    const Vector3 x = turned(parent, placement.linear().col(0)), y = turned(parent, placement.linear().col(1));
    const double c = std::cos(q_rad[i - 1]), s = std::sin(q_rad[i - 1]);
    posture.rotation[i].col(0) = c * x + s * y;
    posture.rotation[i].col(1) = c * y - s * x;
    posture.rotation[i].col(2) = turned(parent, placement.linear().col(2));
    posture.origin[i] = posture.origin[i - 1] + turned(parent, placement.translation());
  }
  const Matrix3& last = posture.rotation[arm.joints];
  for (int axis = 0; axis < 3; ++axis)
    posture.tool_rotation.col(axis) = turned(last, arm.last_body_from_tool.linear().col(axis));
  posture.tool_position = posture.origin[arm.joints] + turned(last, arm.last_body_from_tool.translation());
  return posture;
}

Capsule placed(const Posture& posture, const LinkShape& shape) {
  const Matrix3& rotation = posture.rotation[shape.body];
  const Vector3& origin = posture.origin[shape.body];
  const Capsule& capsule = shape.capsule_body;
  return {origin + turned(rotation, capsule.start), origin + turned(rotation, capsule.end), capsule.radius_m};
}

PointJacobian point_jacobian(const Posture& posture, int body, const Vector3& p_base) {
  PointJacobian jacobian = PointJacobian::Zero(3, posture.joints);
  for (int i = 1; i <= body; ++i) jacobian.col(i - 1) = posture.rotation[i].col(2).cross(p_base - posture.origin[i]);
  return jacobian;
}

TaskJacobian tool_jacobian(const Posture& posture, int rows) {
  TaskJacobian jacobian(rows, posture.joints);
  jacobian.topRows<3>() = point_jacobian(posture, posture.joints, posture.tool_position);
  if (rows == 6)
    for (int i = 1; i <= posture.joints; ++i) jacobian.col(i - 1).tail<3>() = posture.rotation[i].col(2);
  return jacobian;
}

}  // namespace sidestep
