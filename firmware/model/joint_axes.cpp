#include "firmware/model/joint_axes.h"

namespace sidestep {

JointAxes::JointAxes(const LinkPoses& poses) : joints_(poses.joints) {
  for (int i = 0; i < joints_; ++i) {
    const Vector3 direction = poses.rotation[i + 1].col(2);
    if (poses.prismatic[i])
      lines_[i] = {Vector3::Zero(), direction};
    else
      lines_[i] = {direction, poses.origin[i + 1].cross(direction)};
  }
}

JointVector JointAxes::row(int body, const Vector3& p_base, const Vector3& direction) const {
  const Vector3 moment = p_base.cross(direction);
  JointVector row(joints_);
  for (int i = 0; i < body; ++i) row.coeffRef(i) = lines_[i].direction.dot(moment) + lines_[i].moment.dot(direction);
  for (int i = body; i < joints_; ++i) row.coeffRef(i) = 0.0;  // joints beyond the body
  return row;
}

}  // namespace sidestep
