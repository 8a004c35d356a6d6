#include "host/campaign/scene.h"

#include <algorithm>

namespace sidestep::campaign {

double arrived_within_m(const Family& family) {
  return family.dodge ? kReturned_m : kArrived_m;
}

Joints witness_rad(const Scene& scene, double t_s) {
  if (!scene.witness_path.empty()) return scene.witness_path.position_rad(t_s);
  if (t_s >= scene.witness_s) return scene.goal_rad;
  const double u = std::max(0.0, t_s / scene.witness_s);
  return scene.start_rad + (3.0 - 2.0 * u) * u * u * (scene.goal_rad - scene.start_rad);
}

Joints witness_radps(const Scene& scene, double t_s) {
  if (!scene.witness_path.empty()) return scene.witness_path.velocity_radps(t_s);
  if (t_s >= scene.witness_s || t_s <= 0.0) return Joints::Zero(scene.goal_rad.size());
  const double u = t_s / scene.witness_s;
  return 6.0 * u * (1.0 - u) / scene.witness_s * (scene.goal_rad - scene.start_rad);
}

PointMotion target_at(const Scene& scene, double t_s) {
  if (scene.move_s > 0.0) {
    const int move = std::clamp(static_cast<int>(t_s / scene.move_s), 0, scene.moves - 1);
    return {scene.arm->pose(move % 2 == 0 ? scene.goal_rad : scene.start_rad).tool(), Vector3::Zero()};
  }
  if (!scene.family->chase) return {scene.arm->pose(scene.goal_rad).tool(), Vector3::Zero()};
  const ArmPose witness = scene.arm->pose(witness_rad(scene, t_s));
  return {witness.tool(), tool_jacobian(witness) * witness_radps(scene, t_s)};
}

std::optional<OrientationTarget> orientation_target_at(const Scene& scene, double t_s) {
  const Family& family = *scene.family;
  if (scene.goal_has_orientation)
    return OrientationTarget{Eigen::Quaterniond(scene.arm->pose(scene.goal_rad).tool_rotation), Vector3::Zero()};
  if (!family.full_pose && !family.hold_orientation) return std::nullopt;
  const ArmPose witness = scene.arm->pose(witness_rad(scene, t_s));
  return OrientationTarget{Eigen::Quaterniond(witness.tool_rotation),
                           tool_angular_velocity(witness, witness_radps(scene, t_s))};
}

std::vector<Capsule> capsules_at(const Scene& scene, double t_s) {
  std::vector<Capsule> capsules;
  capsules.reserve(scene.capsules.size());
  for (const CapsulePath& path : scene.capsules) capsules.push_back(path.at(t_s).capsule);
  return capsules;
}

std::vector<sim::Obstacle> boxes_at(const Scene& scene, double t_s) {
  std::vector<sim::Obstacle> boxes(scene.boxes.size());
  for (size_t i = 0; i < boxes.size(); ++i) {
    const PointMotion centre = scene.boxes[i].at(t_s);
    boxes[i].solid.shape = sim::Shape::kBox;
    boxes[i].solid.size_m.setConstant(kBoxEdge_m);
    boxes[i].motion.position_m = centre.position_m;
    boxes[i].motion.velocity_mps = centre.velocity_mps;
  }
  return boxes;
}

double sphere_clearance_at(const Scene& scene, const ArmPose& pose, double t_s, double within_m) {
  double least_m = within_m;
  for (const SpherePath& sphere : scene.spheres)
    least_m = scene.arm->clearance(pose, sphere.at(t_s).position_m, kSphereRadius_m, least_m);
  return least_m;
}

double clearance_at(const Scene& scene, const ArmPose& pose, double t_s, double within_m) {
  double least_m = sphere_clearance_at(scene, pose, t_s, within_m);
  if (!scene.boxes.empty()) least_m = scene.arm->solid_clearance(pose, boxes_at(scene, t_s), least_m);
  if (!scene.furniture.empty()) least_m = scene.arm->solid_clearance(pose, scene.furniture, least_m);
  return scene.capsules.empty() ? least_m : scene.arm->clearance(pose, capsules_at(scene, t_s), least_m);
}

double pass_begins_s(const Scene& scene) {
  return scene.crossing_s - kPassReach_m / scene.family->speed_mps;
}
double pass_ends_s(const Scene& scene) {
  return scene.crossing_s + kPassReach_m / scene.family->speed_mps;
}

}  // namespace sidestep::campaign
