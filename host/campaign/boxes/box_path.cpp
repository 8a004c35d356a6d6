#include "host/campaign/boxes/box_path.h"

#include <cmath>

namespace sidestep::campaign {

BoxPath::BoxPath(const Vector3& start_m, const Vector3& velocity_mps, double ahead_m, double behind_m)
    : start_m_(start_m),
      velocity_mps_(velocity_mps),
      speed_mps_(velocity_mps.norm()),
      ahead_m_(ahead_m),
      behind_m_(behind_m) {}

PointMotion BoxPath::at(double t_s) const {
  if (t_s <= 0.0 || speed_mps_ == 0.0) return {start_m_, velocity_mps_};
  const double line_m = ahead_m_ + behind_m_;
  const double way_m = std::fmod(behind_m_ + speed_mps_ * t_s, 2.0 * line_m);  // from the end behind the start
  const bool forth = way_m < line_m;
  const double along_m = (forth ? way_m : 2.0 * line_m - way_m) - behind_m_;
  return {start_m_ + along_m / speed_mps_ * velocity_mps_, forth ? velocity_mps_ : Vector3(-velocity_mps_)};
}

std::vector<double> BoxPath::turns_s(double until_s) const {
  std::vector<double> turns;
  if (speed_mps_ == 0.0) return turns;
  for (int k = 0;; ++k) {
    const double turn_s = (ahead_m_ + k * (ahead_m_ + behind_m_)) / speed_mps_;
    if (turn_s > until_s) return turns;
    turns.push_back(turn_s);
  }
}

}  // namespace sidestep::campaign
