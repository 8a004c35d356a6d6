#include "firmware/control/validation.h"

#include <cmath>

namespace sidestep {
namespace {

// Larger numbers are garbage, not measurements.
constexpr double kLargestLength_m = 1000.0;
constexpr double kLargestSpeed_mps = 1000.0;
constexpr double kLargestRate_radps = 1000.0;
constexpr double kLargestJoint_rad = 1000.0;
constexpr double kUnitTolerance = 1e-3;  // of a quaternion's length

template <typename Vector>
bool within(const Vector& vector, double bound) {
  return vector.allFinite() && vector.cwiseAbs().maxCoeff() <= bound;
}

bool is_unit(const Quaternion& quaternion) {
  return std::abs(quaternion.norm() - 1.0) < kUnitTolerance;
}

}  // namespace

bool plausible(const ArmState& state, int joints) {
  return state.position_rad.size() == joints && state.velocity_radps.size() == joints &&
         within(state.position_rad, kLargestJoint_rad) && within(state.velocity_radps, kLargestRate_radps);
}

bool plausible(const Target& target) {
  const bool finite = target.orientation.coeffs().allFinite() && target.angular_velocity_radps.allFinite();
  const bool pose_valid = !target.tracks_orientation ||
                          (is_unit(target.orientation) && within(target.angular_velocity_radps, kLargestRate_radps));
  if (target.is_posture() && !within(target.posture_rad, kLargestJoint_rad)) return false;
  return finite && pose_valid && within(target.position_m, kLargestLength_m) &&
         within(target.velocity_mps, kLargestSpeed_mps);
}

bool plausible(const Obstacle& obstacle) {
  const Capsule& capsule = obstacle.capsule;
  return within(capsule.start, kLargestLength_m) && within(capsule.end, kLargestLength_m) && capsule.radius_m >= 0.0 &&
         capsule.radius_m <= kLargestLength_m && within(obstacle.half_width_m, kLargestLength_m) &&
         obstacle.half_thickness_m >= 0.0 && obstacle.half_thickness_m <= kLargestLength_m &&
         within(obstacle.velocity_mps, kLargestSpeed_mps) &&
         within(obstacle.angular_velocity_radps, kLargestRate_radps) &&
         (obstacle.kind == Kind::kThing || obstacle.kind == Kind::kPerson);
}

bool plausible(const OtherJoints& joints) {
  for (size_t j = 0; j < joints.position.size(); ++j)
    if (joints.named[j] && !(std::abs(joints.position[j]) <= kLargestJoint_rad)) return false;
  return true;
}

bool plausible(const Control& control) {
  const auto command = static_cast<int>(control.command);
  return command >= 0 && command <= 2 && control.speed_scale >= 0.0 && control.speed_scale <= 1.0;
}

bool sanitize(Target& target) {
  if (!plausible(target)) return false;
  if (target.is_posture()) {
    Target posture;
    posture.utime = target.utime;
    posture.posture_rad = target.posture_rad;
    target = posture;
    return true;
  }
  target.orientation = target.tracks_orientation ? target.orientation.normalized() : Quaternion::Identity();
  if (!target.tracks_orientation) target.angular_velocity_radps.setZero();
  return true;
}

bool sanitize(ObstacleSet& set) {
  for (int i = 0; i < set.count; ++i) {
    Obstacle& obstacle = set.obstacles[static_cast<size_t>(i)];
    if (!plausible(obstacle)) return false;
    if (obstacle.shape == Shape::kSphere) obstacle.angular_velocity_radps.setZero();
  }
  return true;
}

bool sanitize(Attachments& attachments) {
  for (Obstacle& shape : attachments.shapes) {
    if (!plausible(shape)) return false;
    shape.velocity_mps.setZero();
    shape.angular_velocity_radps.setZero();
  }
  return true;
}

Obstacle reported_obstacle(Shape shape, const Vector3& centre, const Quaternion& orientation, const Vector3& size_m) {
  Obstacle invalid = sphere_obstacle(centre, std::nan(""));
  if (!size_m.allFinite()) return invalid;
  if (shape == Shape::kSphere) return sphere_obstacle(centre, size_m[0]);
  if (size_m.minCoeff() < 0.0 || !is_unit(orientation)) return invalid;
  const Matrix3 rotation = orientation.normalized().toRotationMatrix();
  if (shape == Shape::kCapsule) return capsule_obstacle(centre, rotation, size_m[0], size_m[1]);
  if (shape == Shape::kCylinder) return cylinder_obstacle(centre, rotation, size_m[0], size_m[1]);
  return shape == Shape::kBox ? box_obstacle(centre, rotation, size_m) : invalid;
}

}  // namespace sidestep
