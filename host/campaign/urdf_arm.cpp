#include "host/campaign/urdf_arm.h"

#include <algorithm>
#include <cmath>

#include "firmware/model/kinematics.h"
#include "firmware/model/link_proximity.h"
#include "host/campaign/solids.h"

namespace sidestep::campaign {
namespace {

constexpr double kCoincident_m = 1e-3;

/// Limits a joint range of more than one revolution to one revolution around its middle.
void cut_to_one_turn(double& lower_rad, double& upper_rad) {
  if (upper_rad - lower_rad <= 2.0 * M_PI) return;
  const double middle_rad = std::isfinite(upper_rad - lower_rad) ? 0.5 * (lower_rad + upper_rad) : 0.0;
  lower_rad = middle_rad - M_PI;
  upper_rad = middle_rad + M_PI;
}

}  // namespace

UrdfArm::UrdfArm(const Config& config)
    : source_{config.robot.urdf, config.robot.base, config.robot.tip, config.file},
      truth_(sim::Arm(config.robot.urdf, config.robot.base, config.robot.tip, config.robot.meshes.package_path,
                      config.robot.joint_positions)),
      model_(config.model) {}

ArmPose UrdfArm::pose(const Joints& q_rad) const {
  const auto truth = std::make_shared<sim::Truth>(truth_);  // the copy shares the meshes
  truth->place(q_rad);
  ArmPose pose;
  pose.tool_rotation = truth->arm().base_from_tool().linear();
  pose.corners.emplace_back(Vector3::Zero());
  for (const sim::JointAxis& joint : truth->arm().axes()) {
    pose.axes.push_back(joint.direction);
    pose.prismatic.push_back(joint.prismatic);
    pose.origins.push_back(joint.origin_m);
    if ((joint.origin_m - pose.corners.back()).norm() > kCoincident_m) pose.corners.push_back(joint.origin_m);
  }
  pose.corners.push_back(truth->tool_m());
  pose.truth = truth;
  pose.links = forward_kinematics(model_.arm, q_rad);
  return pose;
}

double UrdfArm::clearance(const ArmPose& pose, const Vector3& center_m, double radius_m, double within_m) const {
  sim::Obstacle sphere;
  sphere.solid.size_m.x() = radius_m;
  sphere.motion.position_m = center_m;
  return pose.truth->nearest({sphere}, within_m).clearance_m;
}

double UrdfArm::clearance(const ArmPose& pose, const std::vector<Capsule>& capsules, double within_m) const {
  std::vector<sim::Obstacle> obstacles;
  obstacles.reserve(capsules.size());
  for (const Capsule& capsule : capsules) obstacles.push_back(capsule_obstacle(capsule));
  return solid_clearance(pose, obstacles, within_m);
}

double UrdfArm::solid_clearance(const ArmPose& pose, const std::vector<sim::Obstacle>& solids, double within_m) const {
  return std::min(within_m, pose.truth->nearest(solids, within_m).clearance_m);
}

std::vector<Capsule> UrdfArm::enclosing_capsules(const Joints& q_rad) const {
  const LinkPoses poses = forward_kinematics(model_.arm, q_rad);
  std::vector<Capsule> links;
  links.reserve(model_.arm.shapes.size());
  for (const LinkShape& shape : model_.arm.shapes) links.push_back(transformed(poses, shape));
  return links;
}

double UrdfArm::self_clearance(const ArmPose& pose, double within_m) const {
  return std::min(within_m, pose.truth->nearest_links(within_m).clearance_m);
}

double UrdfArm::controller_clearance(const ArmPose& pose, const Vector3& center_m, double radius_m) const {
  double least_m = sim::kNothingNear;
  const ConvexSolid sphere = ConvexSolid::of(Capsule{center_m, center_m, radius_m});
  for (const LinkShape& shape : model_.arm.shapes) {
    const Capsule capsule = transformed(pose.links, shape);
    const Vector3 away = capsule.centre() - center_m;
    if (away.norm() - capsule.extent_m() - radius_m >= least_m) continue;
    least_m = std::min(least_m, gap_between(solid_of(pose.links, shape), sphere, away, least_m).distance_m);
  }
  return least_m;
}

double UrdfArm::controller_solid_clearance(const ArmPose& pose, const std::vector<sim::Obstacle>& solids) const {
  double least_m = sim::kNothingNear;
  for (const sim::Obstacle& solid : solids) {
    const Obstacle obstacle = reported(solid);
    for (const LinkShape& shape : model_.arm.shapes) {
      const Vector3 away = transformed(pose.links, shape).centre() - obstacle.capsule.centre();
      const SolidGap gap = gap_between(solid_of(pose.links, shape), solid_of(obstacle), away, least_m);
      least_m = std::min(least_m, gap.distance_m);
    }
  }
  return least_m;
}

bool UrdfArm::keeps_clear_of_itself(const ArmPose& pose) const {
  return std::all_of(model_.self_pairs.begin(), model_.self_pairs.end(), [&](const SelfPair& pair) {
    const ConvexSolid a = solid_of(pose.links, model_.arm.shapes[static_cast<size_t>(pair.first)]);
    const ConvexSolid b = solid_of(pose.links, model_.arm.shapes[static_cast<size_t>(pair.second)]);
    return gap_between(a, b, a.centre - b.centre, pair.clearance_m).distance_m >= pair.clearance_m;
  });
}

Limits UrdfArm::limits(const Family&) const {
  return model_.arm.limits;
}

ArmSource UrdfArm::source(const Family&) const {
  return source_;
}

Limits UrdfArm::range() const {
  Limits range = model_.arm.limits;
  for (int i = 0; i < model_.arm.joints; ++i)
    if (!model_.arm.prismatic[i]) cut_to_one_turn(range.lower_rad[i], range.upper_rad[i]);
  return range;
}

}  // namespace sidestep::campaign
