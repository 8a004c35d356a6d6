#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "firmware/base/bounded_list.h"
#include "firmware/model/types.h"

namespace sidestep {

constexpr int kMaxOtherJoints = 96;  ///< movable joints outside the chain that carry shapes: two hands with 40 each

/// A movable joint that is no part of the chain but moves shapes: a lift below the base, a head, another arm, fingers.
/// Its frame moves with the links that it carries, seen from the body of the arm: for a joint below the base these are
/// the links below the joint.
struct OtherJoint {
  std::string name;
  int body = 0;     ///< of the arm, which carries it
  int parent = -1;  ///< index of the other joint that carries it, a lower one; -1: it is fixed to the body
  Eigen::Isometry3d parent_from_joint = Eigen::Isometry3d::Identity();  ///< at position 0, in the frame of its parent
  Vector3 axis = Vector3::UnitZ();                                      ///< unit, in its own frame
  bool prismatic = false;
  double fastest = 0.0;  ///< rad/s, or m/s; 0: no limit is known
  /// A joint that mimics another has the position multiplier * (that of joint `mimics`) + offset. -1: none.
  int mimics = -1;
  double multiplier = 1.0;
  double offset = 0.0;
};

/// Positions (rad, or m) and velocities of the joints outside the chain, in the order of Arm::other_joints.
struct OtherJoints {
  int64_t utime = 0;
  std::array<bool, kMaxOtherJoints> named{};  ///< those that the message names
  std::array<double, kMaxOtherJoints> position{};
  std::array<double, kMaxOtherJoints> velocity{};
};

struct Attachments;

/// The frame of a joint outside the chain, in the frame of the arm's body that carries it, and its velocity.
struct OtherFrame {
  Matrix3 rotation;
  Vector3 origin;         ///< m
  double velocity = 0.0;  ///< rad/s, or m/s
};

/// What hangs on the chain: where the joints outside it are, and what the tool holds.
struct OtherFrames {
  BoundedList<OtherFrame, kMaxOtherJoints> joints;  ///< in the order of Arm::other_joints
  const Attachments* attachments = nullptr;         ///< null: nothing; must outlive this
};

struct Arm;

/// Takes time proportional to the number of joints; no allocation. Positions of joints that mimic others are ignored.
OtherFrames place_other_joints(const Arm& arm, const OtherJoints& joints);

struct LinkPoses;

/// The velocity, by the joints outside the chain, of a point p_base (m) that is fixed to the frame of `other_joint`, as
/// seen from the body of the arm, in the base frame, m/s. -1: zero.
Vector3 other_velocity_at(const Arm& arm, const LinkPoses& poses, int other_joint, const Vector3& p_base);

}  // namespace sidestep
