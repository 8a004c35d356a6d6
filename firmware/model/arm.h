#pragma once

#include <array>
#include <kdl/chain.hpp>
#include <string>
#include <vector>

#include "firmware/model/capsule.h"
#include "firmware/model/types.h"

namespace sidestep {

/// Per joint, n x 1. Position limits are infinite for a continuous joint.
struct JointLimits {
  JointVector lower_rad;
  JointVector upper_rad;
  JointVector velocity_radps;
  JointVector acceleration_radps2;
};

/// A capsule that encloses one collision shape of the URDF, or one slice of a mesh.
struct LinkShape {
  std::string link;
  int body;                ///< 0 is the base; body i moves with joints 1 to i
  Capsule capsule_body;    ///< in the frame of its body
  double slack_m = 0.0;    ///< largest distance from the surface of a mesh's capsules to the mesh; 0 for other shapes
  bool below_arm = false;  ///< belongs to the structure that the base link is fixed to, not to the arm
};

/// A serial arm of n joints: the KDL chain from the base link to the tip link, and the same chain reduced to one frame
/// per joint, which the control cycle uses.
///
/// Body i is joint i's moving link with all links that are rigidly fixed to it. The origin of its frame lies on the
/// axis of joint i, its z axis along it, so that body(i-1)_from_body(i) = joint_placement[i] * Rz(q_i). Body 0 is the
/// base.
struct Arm {
  KDL::Chain chain;
  int joints = 0;  ///< n, kMinJoints to kMaxJoints
  std::vector<std::string> joint_names;
  std::array<Eigen::Isometry3d, kMaxJoints + 1> joint_placement;  ///< of joint i in body i - 1, for i = 1 to n
  Eigen::Isometry3d last_body_from_tool;
  JointLimits limits;
  std::vector<LinkShape> shapes;     ///< 1 to kMaxShapes
  std::vector<std::string> remarks;  ///< one sentence per peculiarity of the URDF that is no error
};

}  // namespace sidestep
