#include "host/campaign/lwa3_arm.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "host/campaign/config_name.h"
#include "host/campaign/family.h"
#include "host/campaign/segment.h"
#include "host/campaign/solids.h"

namespace sidestep::campaign {
namespace {

constexpr size_t kJoints = 7;
constexpr std::array<double, kJoints> kAlphaSign{0, 1, -1, 1, -1, 1, -1};  // alpha = sign * pi / 2
constexpr std::array<double, kJoints> kOffset_m{0.3, 0, 0.328, 0, 0.2765, 0, 0};
constexpr double kTool_m = 0.3372;

Limits symmetric(double odd_rad, double rad_2, double rad_4, double rad_6, double velocity_radps) {
  Limits limits;
  limits.upper_rad.resize(kJoints);
  limits.upper_rad << odd_rad, rad_2, odd_rad, rad_4, odd_rad, rad_6, odd_rad;
  limits.lower_rad = -limits.upper_rad;
  limits.velocity_radps = Joints::Constant(kJoints, velocity_radps);
  limits.acceleration_radps2 = Joints::Constant(kJoints, 10.0);
  return limits;
}

/// Families with the limits of the URDF; the others have those of range().
bool has_full_limits(const Family& family) {
  return family.dodge || family.has_people() || family.boxes;
}

}  // namespace

ArmPose Lwa3Arm::pose(const Joints& q_rad) const {
  ArmPose pose;
  Matrix3 rotation = Matrix3::Identity();
  Vector3 origin = Vector3::Zero();
  for (size_t i = 0; i < kJoints; ++i) {
    // Craig: rotate by alpha about x, translate by d along the new z, rotate by q about the new z.
    if (kAlphaSign[i] != 0.0) {
      const Vector3 y = rotation.col(1);
      rotation.col(1) = kAlphaSign[i] * rotation.col(2);
      rotation.col(2) = -kAlphaSign[i] * y;
    }
    origin += kOffset_m[i] * rotation.col(2);
    const double c = std::cos(q_rad[static_cast<int>(i)]), s = std::sin(q_rad[static_cast<int>(i)]);
    const Vector3 x = rotation.col(0), y = rotation.col(1);
    rotation.col(0) = c * x + s * y;
    rotation.col(1) = c * y - s * x;
    pose.axes.push_back(rotation.col(2));
    pose.origins.push_back(origin);
  }
  pose.corners = {Vector3::Zero(), pose.origins[0], pose.origins[2], pose.origins[4],
                  origin + kTool_m * rotation.col(2)};
  pose.tool_rotation = rotation;
  return pose;
}

double Lwa3Arm::clearance(const ArmPose& pose, const Vector3& center_m, double radius_m, double within_m) const {
  double least_m = distance_to_segment(pose.corners[0], pose.corners[1], center_m);
  for (size_t i = 1; i < 4; ++i)
    least_m = std::min(least_m, distance_to_segment(pose.corners[i], pose.corners[i + 1], center_m));
  return std::min(within_m, least_m - kLinkRadius_m - radius_m);
}

double Lwa3Arm::clearance(const ArmPose& pose, const std::vector<Capsule>& capsules, double within_m) const {
  double least_m = within_m;
  for (const Capsule& capsule : capsules) {
    for (size_t i = 0; i < 4; ++i) {
      const double axes_m = segment_distance(pose.corners[i], pose.corners[i + 1], capsule.start, capsule.end);
      least_m = std::min(least_m, axes_m - kLinkRadius_m - capsule.radius_m);
    }
  }
  return least_m;
}

double Lwa3Arm::solid_clearance(const ArmPose& pose, const std::vector<sim::Obstacle>& solids, double within_m) const {
  double least_m = within_m;
  for (size_t i = 0; i + 1 < pose.corners.size(); ++i) {
    const sim::Obstacle link = capsule_obstacle({pose.corners[i], pose.corners[i + 1], kLinkRadius_m});
    const Eigen::Isometry3d base_from_link = link.motion.base_from_body();
    for (const sim::Obstacle& solid : solids) {
      if (sim::lower_bound_m(link.solid, base_from_link, solid) >= least_m) continue;
      least_m = std::min(
          least_m, sim::signed_distance_m(solid.solid, solid.motion.base_from_body(), link.solid, base_from_link));
    }
  }
  return least_m;
}

std::vector<Capsule> Lwa3Arm::enclosing_capsules(const Joints& q_rad) const {
  const ArmPose arm = pose(q_rad);
  std::vector<Capsule> links;
  for (size_t i = 0; i < 4; ++i) links.push_back({arm.corners[i], arm.corners[i + 1], kLinkRadius_m});
  return links;
}

double Lwa3Arm::self_clearance(const ArmPose& pose, double within_m) const {
  double least_m = within_m;
  for (size_t a = 0; a + 1 < pose.corners.size(); ++a) {
    for (size_t b = a + 2; b + 1 < pose.corners.size(); ++b) {
      const double axes_m =
          segment_distance(pose.corners[a], pose.corners[a + 1], pose.corners[b], pose.corners[b + 1]);
      least_m = std::min(least_m, axes_m - kLinkRadius_m - kLinkRadius_m);
    }
  }
  return least_m;
}

Limits Lwa3Arm::range() const {
  return symmetric(2.9, 1.9, 2.1, 2.0, 1.2);
}

Limits Lwa3Arm::limits(const Family& family) const {
  return has_full_limits(family) ? symmetric(6.25, 1.97, 1.97, 1.97, 2.0) : range();
}

ArmSource Lwa3Arm::source(const Family& family) const {
  return {"urdf/lwa3.urdf", "base_link", "tool",
          config_name(has_full_limits(family) ? "firmware/config/lwa3.yaml" : "host/campaign/benchmark.yaml")};
}

const JudgeArm& lwa3_arm() {
  static const Lwa3Arm arm;
  return arm;
}

}  // namespace sidestep::campaign
