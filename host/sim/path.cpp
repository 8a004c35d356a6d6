#include "host/sim/path.h"

#include <algorithm>

namespace sidestep::sim {

Waypoint waypoint_at(const Path& path, double t_s) {
  const auto is_before = [](double time_s, const Waypoint& waypoint) { return time_s < waypoint.t_s; };
  const auto to = std::upper_bound(path.begin(), path.end(), t_s, is_before);
  const Waypoint& from = to == path.begin() ? path.front() : *(to - 1);
  const double dt_s = t_s - from.t_s;
  if (to == path.begin() || to == path.end()) {
    return {t_s, from.position_m + dt_s * from.velocity_mps, from.velocity_mps};
  }
  const double duration_s = to->t_s - from.t_s, u = dt_s / duration_s;
  const Eigen::Vector3d mean_mps = (to->position_m - from.position_m) / duration_s;
  const Eigen::Vector3d linear = 3.0 * mean_mps - 2.0 * from.velocity_mps - to->velocity_mps;
  const Eigen::Vector3d square = from.velocity_mps + to->velocity_mps - 2.0 * mean_mps;
  return {t_s, from.position_m + dt_s * (from.velocity_mps + u * (linear + u * square)),
          from.velocity_mps + u * (2.0 * linear + 3.0 * u * square)};
}

}  // namespace sidestep::sim
