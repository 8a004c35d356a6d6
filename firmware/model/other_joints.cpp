#include "firmware/model/other_joints.h"

#include "firmware/model/kinematics.h"

namespace sidestep {
namespace {

/// The value of joint j, or of the joint that it mimics.
double resolved(const OtherJoint& joint, const std::array<double, kMaxOtherJoints>& values, size_t j, double offset) {
  return joint.mimics < 0 ? values[j] : joint.multiplier * values[static_cast<size_t>(joint.mimics)] + offset;
}

}  // namespace

OtherFrames place_other_joints(const Arm& arm, const OtherJoints& joints) {
  OtherFrames frames;
  for (size_t j = 0; j < arm.other_joints.size(); ++j) {
    const OtherJoint& joint = arm.other_joints[j];
    const double q = resolved(joint, joints.position, j, joint.offset);
    const Matrix3 placement = joint.parent_from_joint.linear();
    OtherFrame frame{placement, joint.parent_from_joint.translation(), resolved(joint, joints.velocity, j, 0.0)};
    if (joint.prismatic)
      frame.origin += placement * (q * joint.axis);
    else
      frame.rotation = placement * Eigen::AngleAxisd(q, joint.axis).toRotationMatrix();
    if (joint.parent >= 0) {
      const OtherFrame& parent = frames.joints[joint.parent];
      frame.origin = parent.origin + parent.rotation * frame.origin;
      frame.rotation = (parent.rotation * frame.rotation).eval();
    }
    frames.joints.add(frame);
  }
  return frames;
}

Vector3 other_velocity_at(const Arm& arm, const LinkPoses& poses, int other_joint, const Vector3& p_base) {
  Vector3 velocity_mps = Vector3::Zero();
  for (int j = other_joint; j >= 0; j = arm.other_joints[static_cast<size_t>(j)].parent) {
    const OtherJoint& joint = arm.other_joints[static_cast<size_t>(j)];
    const double velocity = poses.others->joints[j].velocity;
    if (velocity == 0.0) continue;
    const auto frame = static_cast<size_t>(other_frame(j));
    const Vector3 axis = poses.rotation[frame] * joint.axis;
    velocity_mps += velocity * (joint.prismatic ? axis : Vector3(axis.cross(p_base - poses.origin[frame])));
  }
  return velocity_mps;
}

}  // namespace sidestep
