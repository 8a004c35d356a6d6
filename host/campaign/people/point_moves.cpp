#include "host/campaign/people/point_moves.h"

#include <algorithm>

#include "host/people/postures.h"

namespace sidestep::campaign {

void PointMoves::move_to(const Eigen::Vector3d& point_m, double duration_s) {
  moves_.push_back({end_s_, duration_s, point_m});
  end_s_ += duration_s;
}

Eigen::Vector3d PointMoves::at(double t_s) const {
  Eigen::Vector3d point_m = start_m_;
  for (const Move& move : moves_) {
    if (t_s <= move.begin_s) break;
    const double u = std::min(1.0, (t_s - move.begin_s) / move.duration_s);
    point_m += minimum_jerk(u) * (move.to_m - point_m);
  }
  return point_m;
}

}  // namespace sidestep::campaign
