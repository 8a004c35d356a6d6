#pragma once

#include <array>
#include <bitset>
#include <cmath>
#include <kdl/chain.hpp>
#include <memory>
#include <string>
#include <vector>

#include "firmware/model/body_shape.h"
#include "firmware/model/other_joints.h"
#include "firmware/model/types.h"

namespace sidestep {

/// Per joint, n x 1: rad, rad/s and rad/s2, or m, m/s and m/s2 for a prismatic joint. That holds for every joint vector
/// of the project, whatever unit its name ends with. Position limits are infinite for a continuous joint.
struct JointLimits {
  JointVector lower_rad;
  JointVector upper_rad;
  JointVector velocity_radps;
  JointVector acceleration_radps2;
};

/// A position limit; half a turn from q where a joint has none. (A prismatic joint has one.)
inline double lower_or_half_turn(const JointLimits& limits, const JointVector& q_rad, Eigen::Index i) {
  return std::isfinite(limits.lower_rad[i]) ? limits.lower_rad[i] : q_rad[i] - M_PI;
}
inline double upper_or_half_turn(const JointLimits& limits, const JointVector& q_rad, Eigen::Index i) {
  return std::isfinite(limits.upper_rad[i]) ? limits.upper_rad[i] : q_rad[i] + M_PI;
}

/// One collision shape of the URDF, or one convex piece of a mesh.
struct LinkShape : BodyShape {
  std::string link;
  bool below_arm = false;  ///< belongs to the structure that carries the base link, not to the arm
  std::shared_ptr<const Polyhedron> polyhedron = nullptr;  ///< that of `solid`
  double excess_p95_m = 0.0;  ///< 95 % of the surface of a mesh's pieces are less far from the mesh; 0 for other shapes
  double excess_m = 0.0;      ///< the largest distance
};

/// Two shapes, as indices into Arm::shapes, that keep clear of each other.
struct SelfPair {
  int first, second;
  double clearance_m;
};

/// Where joints are compared, this motion of a prismatic joint counts as much as 1 rad of another joint: the lever at
/// which a joint of an arm typically moves the links behind it. It weighs the joints' motion in the law's damped
/// inverse and in the shield's programme, and turns settings in rad, rad/s and rad/s2 into m, m/s and m/s2.
constexpr double kPrismaticScale_m = 0.25;  // a power of two: multiplying by it is exact

/// Norms of a joint vector, n x 1, in units of Arm::joint_scale: the largest component and the Euclidean norm.
inline double max_norm(const JointVector& vector, const JointVector& joint_scale) {
  return vector.cwiseQuotient(joint_scale).cwiseAbs().maxCoeff();
}
inline double euclidean_norm(const JointVector& vector, const JointVector& joint_scale) {
  return vector.cwiseQuotient(joint_scale).norm();
}

/// A serial arm of n joints: the KDL chain from the base link to the tip link, and the same chain reduced to one frame
/// per joint, which the control cycle uses.
///
/// Body i is joint i's moving link with all links that are rigidly fixed to it. The origin of its frame lies on the
/// axis of joint i, its z axis along it, so that body(i-1)_from_body(i) = joint_placement[i] * Rz(q_i), or * Tz(q_i)
/// for a prismatic joint. Body 0 is the base.
struct Arm {
  KDL::Chain chain;
  int joints = 0;  ///< n, kMinJoints to kMaxJoints
  std::vector<std::string> joint_names;
  std::bitset<kMaxJoints> prismatic;  ///< per joint, from 0; the others are revolute or continuous
  JointVector joint_scale;            ///< n x 1: 1, or kPrismaticScale_m for a prismatic joint
  std::array<Eigen::Isometry3d, kMaxJoints + 1> joint_placement;  ///< of joint i in body i - 1, for i = 1 to n
  Eigen::Isometry3d last_body_from_tool;
  JointLimits limits;
  std::vector<LinkShape> shapes;         ///< 1 to kMaxLinkShapes
  std::vector<OtherJoint> other_joints;  ///< at most kMaxOtherJoints, parents first
  OtherJoints other_positions;           ///< their positions unless a message tells others
  OtherFrames other_frames;              ///< the frames at these positions
  std::vector<std::string> remarks;      ///< one sentence per peculiarity of the URDF that is no error
  std::vector<std::string> warnings;     ///< remarks on what may not be as it seems: joints outside the chain whose
                                         ///< position nobody gave, limits that look like degrees
};

}  // namespace sidestep
