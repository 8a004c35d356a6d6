#include "firmware/control/other_joint_memory.h"

#include <algorithm>
#include <cmath>

namespace sidestep {

OtherJointMemory::OtherJointMemory(const Arm& arm, double timeout_s)
    : timeout_s_(timeout_s), joints_(arm.other_joints.size()), last_(arm.other_positions) {
  for (size_t j = 0; j < joints_; ++j) {
    const double fastest = arm.other_joints[j].fastest;
    fastest_[j] = fastest > 0.0 ? fastest : HUGE_VAL;
  }
}

void OtherJointMemory::complete(OtherJoints& joints) {
  for (size_t j = 0; j < joints_; ++j) {
    const double elapsed_s = static_cast<double>(joints.utime - named_utime_[j]) * 1e-6;
    const bool is_recent = last_.named[j] && elapsed_s > 0.0 && elapsed_s <= timeout_s_;
    if (!is_recent) last_.velocity[j] = 0.0;
    if (!joints.named[j]) continue;
    if (is_recent)
      last_.velocity[j] = std::clamp((joints.position[j] - last_.position[j]) / elapsed_s, -fastest_[j], fastest_[j]);
    last_.position[j] = joints.position[j];
    last_.named[j] = true;
    named_utime_[j] = joints.utime;
  }
  last_.utime = joints.utime;
  joints = last_;
}

}  // namespace sidestep
