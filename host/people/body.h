#pragma once

#include <array>

#include "firmware/model/capsule.h"

namespace sidestep {

/// The capsules of a person, in the order of obstacles; left parts first.
enum BodyPart {
  kTorso,
  kShoulders,
  kHead,
  kUpperArmLeft,
  kUpperArmRight,
  kForearmLeft,
  kForearmRight,
  kHandLeft,
  kHandRight,
  kThighLeft,
  kThighRight,
  kShankLeft,
  kShankRight,
  kBodyParts
};

/// Lengths between joints, m. Shares of the stature: Drillis and Contini (1966).
struct Anatomy {
  double stature_m;
  double arm_radius_m;  ///< of upper arms, forearms and hands

  double hip_height_m() const { return 0.53 * stature_m; }
  double shoulder_height_m() const { return 0.818 * stature_m; }
  double head_height_m() const { return 0.93 * stature_m; }
  double half_shoulders_m() const { return 0.1295 * stature_m; }
  double half_hips_m() const { return 0.055 * stature_m; }
  double upper_arm_m() const { return 0.186 * stature_m; }
  double forearm_m() const { return 0.146 * stature_m; }
  double hand_m() const { return 0.108 * stature_m; }
  double thigh_m() const { return 0.245 * stature_m; }
  double shank_m() const { return 0.246 * stature_m; }
  /// From the shoulder to the middle of the hand with a straight arm.
  double reach_m() const { return upper_arm_m() + forearm_m() + 0.5 * hand_m(); }
};

/// Index of a side: left 0, right 1. The sign of its y axis.
constexpr double sign_of(size_t side) {
  return side == 0 ? 1.0 : -1.0;
}

/// A person at one instant. The person's frame lies on the floor below the hips: x forward, y left, z up.
struct Posture {
  Vector3 floor_m = Vector3::Zero();  ///< origin of the person's frame, base frame
  double heading_rad = 0.0;           ///< of the person's x axis about the base frame's z axis
  double rise_m = 0.0;                ///< of the whole body; positive up
  double lean_rad = 0.0;              ///< of the trunk, forward
  /// Middle of the hand, relative to the shoulder of an upright person, in the person's frame. Farther than the arm
  /// reaches: in this direction.
  std::array<Vector3, 2> hand_m{Vector3::Zero(), Vector3::Zero()};
  std::array<double, 2> hip_rad{};   ///< of the thighs, forward
  std::array<double, 2> knee_rad{};  ///< flexion
};

/// The shoulder of an upright person, person's frame.
Vector3 shoulder_m(const Anatomy& anatomy, size_t side);

/// A hanging arm: Posture::hand_m.
Vector3 hanging_hand_m(const Anatomy& anatomy, size_t side);

/// The person's capsules, base frame.
std::array<Capsule, kBodyParts> capsules_of(const Anatomy& anatomy, const Posture& posture);

}  // namespace sidestep
