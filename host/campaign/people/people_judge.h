#pragma once

#include "host/campaign/judge.h"
#include "host/campaign/people/way_out.h"

namespace sidestep::campaign {

/// The state this long before the end of the period in which the first contact is decides whether it could still be
/// avoided then.
constexpr double kLate_s = 0.5;

/// Compares an arm among persons with one that stays at the start, and with full knowledge of the persons' motion.
class PeopleJudge {
 public:
  explicit PeopleJudge(const Scene& scene) : scene_(scene) {}

  /// Configuration of the arm at the next period, from 0 on.
  void record_state(const Joints& q_rad) { path_rad_.push_back(q_rad); }

  /// To be called after the last period, with the contacts that the judge saw. Writes rest_clearance_m, closing_mps,
  /// way_out and late_way_out.
  void complete(TrialMetrics& metrics, const std::vector<Contact>& contacts) const;

 private:
  ArmInstant at(int period) const;

  /// The speed at which the arm's own motion since the last period made the clearance smaller, persons at rest.
  double closing_mps(const Contact& contact) const;

  const Scene& scene_;
  std::vector<Joints> path_rad_;
};

}  // namespace sidestep::campaign
