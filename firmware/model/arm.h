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

/// One capsule; it encloses one collision shape of the URDF, or a slice of a mesh.
struct LinkShape {
  std::string link;
  int body;                ///< 0 is the base; body i moves with joints 1 to i
  Capsule capsule_body;    ///< in the frame of its body
  double slack_m = 0.0;    ///< how far the capsules around a mesh stand out from it at most; 0 for other shapes
  bool below_arm = false;  ///< not of the arm but of what its base link is fixed to
};

/// A serial arm: the KDL chain between a base and a tip link, and the same chain folded for the control cycle.
///
/// Body i is everything rigidly fixed behind joint i. Its frame has its origin on the axis of joint i and its z along
/// it, so that body(i-1)_from_body(i) = joint_placement[i] * Rz(q_i).
struct Arm {
  KDL::Chain chain;
  int joints = 0;
  std::vector<std::string> joint_names;
  std::array<Eigen::Isometry3d, kMaxJoints + 1> joint_placement;  ///< of joint i in body i - 1, i from 1
  Eigen::Isometry3d last_body_from_tool;
  JointLimits limits;
  std::vector<LinkShape> shapes;
  std::vector<std::string> remarks;  ///< what is odd about the URDF but no error, in words
};

/// Where `package://` is looked for before ROS_PACKAGE_PATH, and how many capsules may stand for one mesh.
struct MeshOptions {
  std::vector<std::string> package_path;
  int capsules_per_mesh = 3;
};

/// Acceleration limit of every joint where nothing else is configured, since a URDF has none.
constexpr double kDefaultAcceleration_radps2 = 10.0;

/// Reads a URDF and takes the chain base -> tip: 6 to 10 revolute or continuous joints, fixed ones anywhere.
/// Collision shapes: spheres; cylinders, boxes and meshes as the capsules that enclose them (mesh.h, capsule_fit.h).
/// What the base link is fixed to (a pedestal, a torso) is there as shapes of body 0. Links fixed to the chain count as
/// part of it; what hangs on a further movable joint (fingers) counts too, as if that joint were at its zero. Throws
/// std::runtime_error with one line that names the file and what is wrong. Limits are checked by check_limits().
Arm load_arm(const std::string& urdf_file, const std::string& base, const std::string& tip,
             const MeshOptions& meshes = {});

/// Throws std::runtime_error, one line, unless the limits are finite where they must be, in order and positive.
void check_limits(const Arm& arm);

}  // namespace sidestep
