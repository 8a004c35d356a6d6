#include "host/people/body.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace sidestep {
namespace {

constexpr double kTorsoRadius_m = 0.15, kShoulderRadius_m = 0.08, kHeadRadius_m = 0.10;
constexpr double kThighRadius_m = 0.08, kShankRadius_m = 0.06;
constexpr double kBent = 0.30, kStraight = 0.985;  // least and largest distance of hand and shoulder, of the reach

using Body = std::array<Capsule, kBodyParts>;

/// Direction in the person's x-z plane, at an angle from straight down, positive forward.
Vector3 down(double angle_rad) {
  return {std::sin(angle_rad), 0.0, -std::cos(angle_rad)};
}

/// The elbow of an arm from the shoulder to the hand, by the law of cosines. It points backward, outward and down.
Vector3 elbow_m(const Anatomy& anatomy, const Vector3& shoulder_m, const Vector3& hand_m, double sign) {
  const double upper_m = anatomy.upper_arm_m(), lower_m = anatomy.reach_m() - upper_m;
  const Vector3 to_hand_m = hand_m - shoulder_m;
  const double length_m = to_hand_m.norm();
  const Vector3 along = to_hand_m / length_m, outward = Vector3(-0.75, 0.4 * sign, -0.5).normalized();
  const double along_m = (upper_m * upper_m - lower_m * lower_m + length_m * length_m) / (2.0 * length_m);
  const double aside_m = std::sqrt(std::max(0.0, upper_m * upper_m - along_m * along_m));
  return shoulder_m + along_m * along + aside_m * (outward - outward.dot(along) * along).normalized();
}

/// Upper arm, forearm and hand, person's frame.
void place_arm(const Anatomy& anatomy, const Vector3& shoulder_m, const Vector3& wanted_m, size_t side, Body& body) {
  const Vector3 wish_m = wanted_m - shoulder_m;
  const double least_m = kBent * anatomy.reach_m(), most_m = kStraight * anatomy.reach_m();
  const Vector3 hand_m = shoulder_m + std::clamp(wish_m.norm(), least_m, most_m) * wish_m.normalized();
  const Vector3 elbow = elbow_m(anatomy, shoulder_m, hand_m, sign_of(side));
  const Vector3 along = (hand_m - elbow).normalized();
  const double radius_m = anatomy.arm_radius_m;
  const double half_hand_m = 0.5 * anatomy.hand_m() - radius_m;
  body[kUpperArmLeft + side] = {shoulder_m, elbow, radius_m};
  body[kForearmLeft + side] = {elbow, elbow + anatomy.forearm_m() * along, radius_m};
  body[kHandLeft + side] = {hand_m - half_hand_m * along, hand_m + half_hand_m * along, radius_m};
}

void place_leg(const Anatomy& anatomy, const Posture& posture, size_t side, Body& body) {
  const Vector3 hip(0.0, sign_of(side) * anatomy.half_hips_m(), anatomy.hip_height_m());
  const Vector3 knee = hip + anatomy.thigh_m() * down(posture.hip_rad[side]);
  const Vector3 ankle = knee + anatomy.shank_m() * down(posture.hip_rad[side] - posture.knee_rad[side]);
  body[kThighLeft + side] = {hip, knee, kThighRadius_m};
  body[kShankLeft + side] = {knee, ankle, kShankRadius_m};
}

}  // namespace

Vector3 shoulder_m(const Anatomy& anatomy, size_t side) {
  return {0.0, sign_of(side) * anatomy.half_shoulders_m(), anatomy.shoulder_height_m()};
}

Vector3 hanging_hand_m(const Anatomy& anatomy, size_t side) {
  return 0.96 * anatomy.reach_m() * Vector3(0.1, 0.12 * sign_of(side), -1.0).normalized();
}

Body capsules_of(const Anatomy& anatomy, const Posture& posture) {
  Body body;
  const Vector3 hips(0.0, 0.0, anatomy.hip_height_m());
  const Eigen::AngleAxisd lean(posture.lean_rad, Vector3::UnitY());
  const auto leaning = [&](const Vector3& upright_m) -> Vector3 { return hips + lean * (upright_m - hips); };
  const double chest_m = anatomy.shoulder_height_m() - kTorsoRadius_m;
  body[kTorso] = {leaning(hips + Vector3(0, 0, 0.05)), leaning({0, 0, chest_m}), kTorsoRadius_m};
  body[kShoulders] = {leaning(shoulder_m(anatomy, 0)), leaning(shoulder_m(anatomy, 1)), kShoulderRadius_m};
  body[kHead] = {leaning({0, 0, anatomy.head_height_m() - 0.03}), leaning({0, 0, anatomy.head_height_m() + 0.03}),
                 kHeadRadius_m};
  for (size_t side : {0u, 1u}) {
    const Vector3 upright_m = shoulder_m(anatomy, side);
    place_arm(anatomy, leaning(upright_m), upright_m + posture.hand_m[side], side, body);
    place_leg(anatomy, posture, side, body);
  }
  const Eigen::AngleAxisd heading(posture.heading_rad, Vector3::UnitZ());
  const Vector3 origin_m = posture.floor_m + Vector3(0, 0, posture.rise_m);
  for (Capsule& capsule : body)
    capsule = {origin_m + heading * capsule.start, origin_m + heading * capsule.end, capsule.radius_m};
  return body;
}

}  // namespace sidestep
