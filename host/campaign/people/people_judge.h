#pragma once

#include "host/campaign/judge.h"
#include "host/campaign/people/way_out.h"

namespace sidestep::campaign {

/// In an approach a capsule comes nearer to the arm by at least this, m/s.
constexpr double kApproach_mps = 0.5;

/// An approach may end so many periods before the contact: the hand slows down, and the arm moves.
constexpr int kSlowPeriods = 5;

/// A search from the state so long before a contact finds ways out that one from the start misses.
constexpr int kLatePeriods = 50;

/// Compares an arm among persons with one that stays at the start, and with full knowledge of the persons' motion.
class PeopleJudge {
 public:
  explicit PeopleJudge(const Scene& scene) : scene_(scene) {}

  /// Configuration of the arm at the next period, from 0 on.
  void record_state(const Joints& q_rad) { path_rad_.push_back(q_rad); }

  /// To be called after the last period, with the contacts that the judge saw. Writes rest_clearance_m, closing_mps,
  /// way_out and seen_way_out.
  void complete(TrialMetrics& metrics, const std::vector<Contact>& contacts) const;

 private:
  ArmInstant at(int period) const;

  /// The speed at which a capsule came nearer to the arm in a period, the arm at rest where it is at its end.
  double approach_mps(const CapsulePath& capsule, int period) const;

  /// The period at whose end the capsule that touches first begins its approach. 0 if it comes without one.
  int approach_begins(const Contact& first) const;

  /// The period at whose end the controller could see this at the earliest.
  int approach_is_seen(const Contact& first) const;

  /// The speed at which the arm's own motion since the last period made the clearance smaller, persons at rest.
  double closing_mps(const Contact& contact) const;

  const Scene& scene_;
  std::vector<Joints> path_rad_;
};

}  // namespace sidestep::campaign
