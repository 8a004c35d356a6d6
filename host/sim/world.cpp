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

}  // namespace

World later(const World& now, double dt_s) {
  World world = now;
  move(world.target.motion, dt_s);
  for (Obstacle& obstacle : world.obstacles) move(obstacle.motion, dt_s);
  return world;
}

}  // namespace sidestep::sim
