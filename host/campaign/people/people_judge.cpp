#include "host/campaign/people/people_judge.h"

#include <algorithm>
#include <cmath>

namespace sidestep::campaign {

ArmInstant PeopleJudge::at(int period) const {
  const Joints& q_rad = path_rad_[static_cast<size_t>(period)];
  if (period == 0) return {0, q_rad, Joints::Zero(q_rad.size())};
  return {period, q_rad, (q_rad - path_rad_[static_cast<size_t>(period) - 1]) / kPeriod_s};
}

double PeopleJudge::closing_mps(int period, double clearance_m) const {
  if (period == 0) return 0.0;
  const ArmPose before = scene_.arm->pose(path_rad_[static_cast<size_t>(period) - 1]);
  return std::max(0.0, (clearance_at(scene_, before, period * kPeriod_s) - clearance_m) / kPeriod_s);
}

void PeopleJudge::complete(TrialMetrics& metrics) const {
  metrics.rest_clearance_m = clearance_at_rest(scene_);
  metrics.way_out = 1.0;  // the trial's own motion, if it is without contact
  if (metrics.clearance_m >= 0.0) return;
  int first = static_cast<int>(path_rad_.size()) - 1;
  metrics.closing_mps = 0.0;
  for (int k = 0; k < static_cast<int>(path_rad_.size()); ++k) {
    const ArmPose pose = scene_.arm->pose(path_rad_[static_cast<size_t>(k)]);
    const double clearance_m = clearance_at(scene_, pose, k * kPeriod_s, 0.0);
    if (clearance_m >= 0.0) continue;
    first = std::min(first, k);
    metrics.closing_mps = std::max(metrics.closing_mps, closing_mps(k, clearance_m));
  }
  const ArmInstant start = at(0), late = at(std::max(0, first - static_cast<int>(std::lround(kLate_s / kPeriod_s))));
  metrics.late_way_out = has_way_out(scene_, late) ? 1.0 : 0.0;
  const bool way_out = metrics.late_way_out > 0.0 || metrics.rest_clearance_m >= 0.0 || has_way_out(scene_, start);
  metrics.way_out = way_out ? 1.0 : 0.0;
}

}  // namespace sidestep::campaign
