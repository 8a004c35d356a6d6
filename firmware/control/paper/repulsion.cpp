#include "firmware/control/paper/repulsion.h"

#include <algorithm>

namespace sidestep {

Vector3 repulsion(const PaperGains& gains, const Vector3& obstacle_position_m, const Vector3& obstacle_velocity_mps,
                  const Vector3& tool_position_m, const Vector3& tool_velocity_mps) {
  const Vector3 away = tool_position_m - obstacle_position_m;
  const double distance_m = away.norm();
  if (distance_m <= 0.0) return Vector3::Zero();  // no direction is better than another
  const Vector3 n = away / distance_m;
  const double rho_m = std::max(distance_m, gains.rho_min_m);
  Vector3 force = Vector3::Zero();
  if (rho_m <= gains.rho_0_m) force += gains.k_rpos_m2ps2 * (1.0 / rho_m - 1.0 / gains.rho_0_m) * n;

  // docs/paper.md item 3: eq (10) as printed pulls the tool after a receding obstacle and is 0/0 at equal speeds.
  const Vector3 closing = obstacle_velocity_mps - tool_velocity_mps;
  if (rho_m <= gains.rho_v_m && closing.dot(n) > 0.0)
    force += gains.k_rvel_m2ps2 * (1.0 / rho_m - 1.0 / gains.rho_v_m) * closing.normalized();
  return force;
}

Vector3 repulsion(const PaperGains& gains, const ObstacleView& view, const Vector3& tool_position_m,
                  const Vector3& tool_velocity_mps) {
  Vector3 force = Vector3::Zero();
  const Capsule tool{tool_position_m, tool_position_m, 0.0};
  const double farthest_m = std::max(gains.rho_0_m, gains.rho_v_m);
  for (int i = 0; i < view.count(); ++i) {
    const Obstacle& obstacle = view.at(i);
    const Vector3 centre = obstacle.capsule.centre() + obstacle.velocity_mps * view.age_s;
    if ((tool_position_m - centre).norm() > farthest_m + obstacle.capsule.extent_m()) continue;
    const Vector3 nearest = measure_pair(tool, view.extrapolated(i)).on_obstacle;
    force += repulsion(gains, nearest, obstacle.velocity_mps, tool_position_m, tool_velocity_mps);
  }
  return force;
}

}  // namespace sidestep
