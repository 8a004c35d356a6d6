#include "host/sim/world.h"

#include <algorithm>

namespace sidestep::sim {
namespace {

void translate(Motion& motion, double dt_s) {
  if (!motion.path) {
    motion.position_m += motion.velocity_mps * dt_s;
    return;
  }
  motion.path_s += dt_s;
  const Waypoint current = waypoint_at(*motion.path, motion.path_s);
  motion.position_m = current.position_m;
  motion.velocity_mps = current.velocity_mps;
}

/// A capsule does not turn about its axis.
void follow(Motion& motion, const CapsuleMotion& now) {
  const Eigen::Vector3d axis_m = now.capsule.end - now.capsule.start, before = motion.orientation * Vector3::UnitZ();
  motion.position_m = now.capsule.centre();
  motion.orientation = (Eigen::Quaterniond::FromTwoVectors(before, axis_m) * motion.orientation).normalized();
  motion.velocity_mps = now.centre_mps();
  motion.angular_velocity_radps = now.angular_radps();
}

void advance(Motion& motion, double dt_s) {
  if (motion.limb) {
    motion.path_s += dt_s;
    return follow(motion, motion.limb->at(motion.path_s));
  }
  translate(motion, dt_s);
  const double speed_radps = motion.angular_velocity_radps.norm();
  if (speed_radps <= 0.0) return;
  const Eigen::AngleAxisd rotation(speed_radps * dt_s, motion.angular_velocity_radps / speed_radps);
  motion.orientation = (rotation * motion.orientation).normalized();
}

Motion transformed(const Eigen::Isometry3d& b_from_a, Motion motion) {
  const Eigen::Matrix3d rotation = b_from_a.linear();
  motion.position_m = b_from_a * motion.position_m;
  motion.velocity_mps = rotation * motion.velocity_mps;
  motion.orientation = Eigen::Quaterniond(rotation) * motion.orientation;
  motion.angular_velocity_radps = rotation * motion.angular_velocity_radps;
  if (motion.limb) motion.limb = std::make_shared<const CapsulePath>(motion.limb->transformed(b_from_a));
  if (!motion.path) return motion;
  Path path = *motion.path;
  for (Waypoint& waypoint : path) {
    waypoint.position_m = b_from_a * waypoint.position_m;
    waypoint.velocity_mps = rotation * waypoint.velocity_mps;
  }
  motion.path = std::make_shared<const Path>(std::move(path));
  return motion;
}

}  // namespace

bool Grip::holds(int32_t id) const {
  return std::any_of(held.begin(), held.end(), [id](const Obstacle& obstacle) { return obstacle.id == id; });
}

bool Grip::allows(int32_t id) const {
  return std::find(allowed.begin(), allowed.end(), id) != allowed.end();
}

std::vector<Obstacle> World::all() const {
  std::vector<Obstacle> all = obstacles;
  all.insert(all.end(), surroundings.begin(), surroundings.end());
  return all;
}

Eigen::Isometry3d Motion::base_from_body() const {
  return Eigen::Translation3d(position_m) * orientation;
}

Motion motion_of_limb(CapsulePath path) {
  Motion motion;
  motion.limb = std::make_shared<const CapsulePath>(std::move(path));
  follow(motion, motion.limb->at(0.0));
  return motion;
}

World advanced(const World& world, double dt_s) {
  World result = world;
  if (result.target) advance(result.target->motion, dt_s);
  for (Obstacle& obstacle : result.obstacles) advance(obstacle.motion, dt_s);
  return result;
}

World transformed(const Eigen::Isometry3d& b_from_a, const World& world) {
  World result = world;
  if (result.target) result.target->motion = transformed(b_from_a, result.target->motion);
  for (Obstacle& obstacle : result.obstacles) obstacle.motion = transformed(b_from_a, obstacle.motion);
  return result;
}

}  // namespace sidestep::sim
