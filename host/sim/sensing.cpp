#include "host/sim/sensing.h"

namespace sidestep::sim {

std::optional<JointVector> Sensing::joints(JointVector q_rad) {
  if (lost()) return {};
  for (double& angle_rad : q_rad) angle_rad += noise(spec_.joint_noise_rad);
  return q_rad;
}

std::optional<Target> Sensing::target(const Target& target) {
  if (lost()) return {};
  return target;
}

std::optional<std::vector<Obstacle>> Sensing::obstacles(std::vector<Obstacle> obstacles) {
  if (lost()) return {};
  for (Obstacle& obstacle : obstacles)
    for (double& coordinate_m : obstacle.motion.position_m) coordinate_m += noise(spec_.obstacle_noise_m);
  return obstacles;
}

}  // namespace sidestep::sim
