#include "host/campaign/people/people_judge.h"

#include <algorithm>
#include <cmath>

namespace sidestep::campaign {

ArmInstant PeopleJudge::at(int period) const {
  const Joints& q_rad = path_rad_[static_cast<size_t>(period)];
  if (period == 0) return {0, q_rad, Joints::Zero(q_rad.size())};
  return {period, q_rad, (q_rad - path_rad_[static_cast<size_t>(period) - 1]) / kPeriod_s};
}

double PeopleJudge::closing_mps(const Contact& contact) const {
  if (contact.period == 0) return 0.0;
  const ArmPose before = scene_.arm->pose(path_rad_[static_cast<size_t>(contact.period) - 1]);
  const double t_s = contact.period * kPeriod_s - contact.back * kPeriod_s, moved_s = (1.0 - contact.back) * kPeriod_s;
  return std::max(0.0, (clearance_at(scene_, before, t_s) - contact.clearance_m) / moved_s);
}

void PeopleJudge::complete(TrialMetrics& metrics, const std::vector<Contact>& contacts) const {
  metrics.rest_clearance_m = clearance_at_rest(scene_);
  metrics.way_out = 1.0;  // the trial's own motion, if it is without contact
  if (contacts.empty()) return;
  metrics.closing_mps = 0.0;
  for (const Contact& contact : contacts) metrics.closing_mps = std::max(metrics.closing_mps, closing_mps(contact));
  const int first = contacts.front().period;
  const ArmInstant start = at(0), late = at(std::max(0, first - static_cast<int>(std::lround(kLate_s / kPeriod_s))));
  metrics.late_way_out = has_way_out(scene_, late) ? 1.0 : 0.0;
  const bool way_out = metrics.late_way_out > 0.0 || metrics.rest_clearance_m >= 0.0 || has_way_out(scene_, start);
  metrics.way_out = way_out ? 1.0 : 0.0;
}

}  // namespace sidestep::campaign
