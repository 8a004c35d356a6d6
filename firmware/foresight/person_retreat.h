#pragma once

#include "firmware/base/split_mix64.h"
#include "firmware/control/types/guide.h"
#include "firmware/foresight/free_space.h"

namespace sidestep {

/// Leads the arm out from among persons. The separation of the shield (constraint_rows.h) follows a gradient: an arm
/// with persons on two sides stays between them, near enough for a stroke of a hand that no arm evades. This search
/// looks farther: for the clearest posture that a straight joint line leads to. It needs no rollout.
///
/// Exposure of a posture: the sum over the moving links of ((R - d) / R)^2 where d < R = 0.6 m, with the distance d of
/// the link's enclosing capsule to the nearest capsule of a person, now or 0.3 s from now. A limb is not extrapolated
/// farther, because it soon stops. With the way there: plus half of the mean exposure along the straight line.
///
/// A posture is squeezed if
///   - a part of a person within 0.5 m is faster than 1.5 m/s; or
///   - two parts within 0.5 m are on opposite sides of the arm (normals more than 90 degrees apart), and one of them is
///     within 0.4 m.
/// Only links from the third joint on count: the others can hardly leave.
///
/// The retreat begins in the second call in a row in which the present posture is squeezed, if a posture is found whose
/// exposure with the way is less than 0.7 of that of staying. Found postures are free (free_space.h), 5 % of the range
/// off the position limits, and the way keeps 60 mm, or loses at most 30 mm of the present clearance. The search goes
/// on meanwhile, and leads to another posture that is better by a fifth. The retreat ends when the posture in which it
/// began was not squeezed for 100 calls, or the target has moved by 50 mm or became another posture.
class PersonRetreat {
 public:
  explicit PersonRetreat(const Model& model) : model_(model), free_(model), random_(model.settings.foresight.seed) {}

  /// One call per snapshot. Returns whether guide() is to be followed; only while tracking. Bounded: 13 ways, of 5
  /// postures each. No allocation. The same sequence of snapshots gives the same guides.
  bool update(const Snapshot& now);

  /// With ForesightStatus::kWaiting; valid while update() returns true.
  const Guide& guide() const { return guide_; }

  /// Forgets the retreat and restarts the random sequence.
  void reset();

 private:
  bool may_begin(const Snapshot& now);
  bool goes_on(const Snapshot& now);
  double exposure(const JointVector& q_rad, const Snapshot& now) const;
  bool is_squeezed(const JointVector& q_rad, const Snapshot& now) const;
  double exposure_with_way(const JointVector& to_rad, double bound, const Snapshot& now) const;
  JointVector random_posture(const JointVector& around_rad, double range_rad);
  void search(const Snapshot& now);
  void lead_to_best(const Snapshot& now);

  const Model& model_;
  FreeSpace free_;  ///< of the last search
  SplitMix64 random_;
  Guide guide_;
  bool retreats_ = false;
  int squeezed_calls_ = 0;            ///< in a row, before a retreat
  int free_calls_ = 0;                ///< in a row in which squeezed_rad_ was not squeezed
  int led_calls_ = 0;                 ///< since the guide was made
  JointVector squeezed_rad_;          ///< where the retreat began
  Target target_;                     ///< when the retreat began
  JointVector best_rad_;              ///< of the search
  double best_exposure_ = kNotFound;  ///< of best_rad_, with the way
  static constexpr double kNotFound = 1e9;
};

}  // namespace sidestep
