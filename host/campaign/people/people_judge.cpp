#include "host/campaign/people/people_judge.h"

#include <algorithm>
#include <cmath>

#include "host/campaign/people/camera.h"

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

double PeopleJudge::approach_mps(const CapsulePath& capsule, int period) const {
  const ArmPose arm = scene_.arm->pose(path_rad_[static_cast<size_t>(period)]);
  const auto clearance_m = [&](int k) { return scene_.arm->clearance(arm, {capsule.at(k * kPeriod_s).capsule}); };
  return (clearance_m(period - 1) - clearance_m(period)) / kPeriod_s;
}

int PeopleJudge::approach_begins(const Contact& first) const {
  const ArmPose arm = scene_.arm->pose(path_rad_[static_cast<size_t>(first.period)]);
  const double t_s = (first.period - first.back) * kPeriod_s;
  const auto clearance_m = [&](const CapsulePath& capsule) {
    return scene_.arm->clearance(arm, {capsule.at(t_s).capsule});
  };
  const CapsulePath& touching =
      *std::min_element(scene_.capsules.begin(), scene_.capsules.end(),
                        [&](const CapsulePath& a, const CapsulePath& b) { return clearance_m(a) < clearance_m(b); });
  const auto approaches = [&](int period) { return period > 0 && approach_mps(touching, period) >= kApproach_mps; };
  int period = first.period;
  while (period > 0 && !approaches(period)) --period;
  if (first.period - period > kSlowPeriods) return 0;
  while (approaches(period)) --period;
  return period;
}

int PeopleJudge::approach_is_seen(const Contact& first) const {
  const double delay_s = scene_.family->camera ? Camera::kDelay_us / 1e6 : 0.0;
  return approach_begins(first) + static_cast<int>(std::lround(delay_s / kPeriod_s));
}

void PeopleJudge::complete(TrialMetrics& metrics, const std::vector<Contact>& contacts) const {
  metrics.rest_clearance_m = clearance_at_rest(scene_);
  metrics.way_out = 1.0;  // the trial's own motion, if it is without contact
  if (contacts.empty()) return;
  metrics.closing_mps = 0.0;
  for (const Contact& contact : contacts) metrics.closing_mps = std::max(metrics.closing_mps, closing_mps(contact));
  const Contact& first = contacts.front();
  const int seen = approach_is_seen(first), late = std::max(0, first.period - kLatePeriods);
  const bool seen_way_out = seen < first.period && has_way_out(scene_, at(seen));
  const bool way_out =
      seen_way_out || metrics.rest_clearance_m >= 0.0 || has_way_out(scene_, at(late)) || has_way_out(scene_, at(0));
  metrics.seen_way_out = seen_way_out ? 1.0 : 0.0;
  metrics.way_out = way_out ? 1.0 : 0.0;
}

}  // namespace sidestep::campaign
