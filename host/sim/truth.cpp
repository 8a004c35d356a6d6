#include "host/sim/truth.h"

#include <algorithm>

namespace sidestep::sim {
namespace {

// Half the axis of a part, in its own frame (docstring of axis_distance_m).
Eigen::Vector3d half_axis_m(const Solid& solid) {
  if (solid.shape == Shape::kSphere) return Eigen::Vector3d::Zero();
  int along = 2;
  double length_m = solid.size_m.y();
  if (solid.shape == Shape::kBox || solid.shape == Shape::kMesh) length_m = solid.size_m.maxCoeff(&along);
  return Eigen::Vector3d::Unit(along) * (length_m / 2.0);
}

double distance_to_axis_m(const ArmPart& part, const Eigen::Vector3d& point_m) {
  const Eigen::Vector3d half_m = part.base_from_part.linear() * half_axis_m(part.solid);
  const Eigen::Vector3d offset_m = point_m - part.base_from_part.translation();
  const double squared = half_m.squaredNorm();
  const double along = squared > 0.0 ? std::clamp(offset_m.dot(half_m) / squared, -1.0, 1.0) : 0.0;
  return (offset_m - along * half_m).norm();
}

// Distance from a point to a box around the origin of a frame, 0 inside.
double distance_to_box_m(const Eigen::Vector3d& point_m, const Eigen::Quaterniond& base_from_box,
                         const Eigen::Vector3d& edges_m) {
  return ((base_from_box.conjugate() * point_m).cwiseAbs() - 0.5 * edges_m).cwiseMax(0.0).norm();
}

}  // namespace

// From the bounding box of a mesh and a box, else from bounding spheres.
double lower_bound_m(const Solid& solid, const Eigen::Isometry3d& base_from_solid, const Obstacle& obstacle) {
  const Eigen::Vector3d offset_m = obstacle.motion.position_m - base_from_solid.translation();
  double bound_m = offset_m.norm() - bounding_radius_m(solid);
  if (solid.shape == Shape::kMesh) {
    const Eigen::Vector3d in_solid_m = base_from_solid.linear().transpose() * offset_m;
    bound_m = (in_solid_m.cwiseAbs() - 0.5 * solid.size_m).cwiseMax(0.0).norm();
  }
  bound_m -= bounding_radius_m(obstacle.solid);
  if (obstacle.solid.shape != Shape::kBox) return bound_m;
  const double to_box_m = distance_to_box_m(offset_m, obstacle.motion.orientation, obstacle.solid.size_m);
  return std::max(bound_m, to_box_m - bounding_radius_m(solid));
}

Nearest Truth::nearest(const std::vector<Obstacle>& obstacles, int last_body, double within_m) const {
  Nearest best;
  best.clearance_m = within_m;
  std::vector<std::pair<double, const ArmPart*>> candidates;  // smallest bound first
  for (size_t i = 0; i < obstacles.size(); ++i) {
    candidates.clear();
    for (const ArmPart& part : arm_.parts()) {
      if (part.body > last_body) continue;
      const double bound_m = lower_bound_m(part.solid, part.base_from_part, obstacles[i]);
      if (bound_m < best.clearance_m) candidates.emplace_back(bound_m, &part);
    }
    std::sort(candidates.begin(), candidates.end());
    const Eigen::Isometry3d base_from_obstacle = obstacles[i].motion.base_from_body();
    for (const auto& [bound_m, part] : candidates) {
      if (bound_m >= best.clearance_m) break;
      const double distance_m = signed_distance_m(part->solid, part->base_from_part, obstacles[i].solid,
                                                  base_from_obstacle, best.clearance_m);
      if (distance_m < best.clearance_m) best = {distance_m, static_cast<int>(i), part->link};
    }
  }
  return best;
}

Nearest Truth::nearest_in(const World& world) const {
  const std::vector<Obstacle> all = world.all();
  if (!world.grip) return nearest(all);
  Nearest best;
  const auto consider = [&best](Nearest found, size_t obstacle) {
    if (found.clearance_m >= best.clearance_m) return;
    best = std::move(found);
    best.obstacle = static_cast<int>(obstacle);
  };
  for (size_t i = 0; i < all.size(); ++i) {
    const bool is_held = world.grip->holds(all[i].id), is_allowed = world.grip->allows(all[i].id);
    const int last_body = is_held ? joints() - 2 : is_allowed ? joints() - 1 : joints();
    consider(nearest({all[i]}, last_body, best.clearance_m), i);
    if (is_held || is_allowed) continue;
    for (const Obstacle& held : world.grip->held) {
      const Eigen::Isometry3d base_from_held = arm_.base_from_tool() * held.motion.base_from_body();
      consider({signed_distance_m(held.solid, base_from_held, all[i].solid, all[i].motion.base_from_body()), 0,
                "held object"},
               i);
    }
  }
  return best;
}

std::vector<Obstacle> Truth::links(const Eigen::Isometry3d& other_from_base) const {
  std::vector<Obstacle> links;
  for (const ArmPart& part : arm_.parts()) {
    const Eigen::Isometry3d pose = other_from_base * part.base_from_part;
    Obstacle& link = links.emplace_back();
    link.id = static_cast<int32_t>(links.size());
    link.solid = part.solid;
    link.motion.position_m = pose.translation();
    link.motion.orientation = Eigen::Quaterniond(pose.linear());
  }
  return links;
}

double Truth::axis_distance_m(const Obstacle& obstacle) const {
  double least_m = kNothingNear;
  for (const ArmPart& part : arm_.parts()) {
    if (part.moving) least_m = std::min(least_m, distance_to_axis_m(part, obstacle.motion.position_m));
  }
  return least_m;
}

double Truth::axis_distance_m(const std::vector<Obstacle>& obstacles) const {
  double least_m = kNothingNear;
  for (const Obstacle& obstacle : obstacles) least_m = std::min(least_m, axis_distance_m(obstacle));
  return least_m;
}

}  // namespace sidestep::sim
