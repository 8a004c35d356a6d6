#include "host/sim/world.h"

namespace sidestep::sim {
namespace {

void translate(Motion& motion, double dt_s) {
  if (!motion.path) {
    motion.position_m += motion.velocity_mps * dt_s;
    return;
  }
  motion.path_s += dt_s;
  const Waypoint now = along(*motion.path, motion.path_s);
  motion.position_m = now.position_m;
  motion.velocity_mps = now.velocity_mps;
}

void move(Motion& motion, double dt_s) {
  translate(motion, dt_s);
  const double speed_radps = motion.angular_velocity_radps.norm();
  if (speed_radps <= 0.0) return;
  const Eigen::AngleAxisd turn(speed_radps * dt_s, motion.angular_velocity_radps / speed_radps);
  motion.orientation = (turn * motion.orientation).normalized();
}

Motion seen_from(const Eigen::Isometry3d& there_from_here, Motion motion) {
  const Eigen::Matrix3d turn = there_from_here.linear();
  motion.position_m = there_from_here * motion.position_m;
  motion.velocity_mps = turn * motion.velocity_mps;
  motion.orientation = Eigen::Quaterniond(turn) * motion.orientation;
  motion.angular_velocity_radps = turn * motion.angular_velocity_radps;
  if (!motion.path) return motion;
  Path path = *motion.path;
  for (Waypoint& waypoint : path) {
    waypoint.position_m = there_from_here * waypoint.position_m;
    waypoint.velocity_mps = turn * waypoint.velocity_mps;
  }
  motion.path = std::make_shared<const Path>(std::move(path));
  return motion;
}

}  // namespace

std::vector<Obstacle> World::all() const {
  std::vector<Obstacle> all = obstacles;
  all.insert(all.end(), surroundings.begin(), surroundings.end());
  return all;
}

World later(const World& now, double dt_s) {
  World world = now;
  move(world.target.motion, dt_s);
  for (Obstacle& obstacle : world.obstacles) move(obstacle.motion, dt_s);
  return world;
}

World seen_from(const Eigen::Isometry3d& there_from_here, const World& world) {
  World seen = world;
  seen.target.motion = seen_from(there_from_here, seen.target.motion);
  for (Obstacle& obstacle : seen.obstacles) obstacle.motion = seen_from(there_from_here, obstacle.motion);
  return seen;
}

}  // namespace sidestep::sim
