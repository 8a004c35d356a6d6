#pragma once

#include "firmware/foresight/snapshot.h"

namespace sidestep {

/// Random numbers that are the same everywhere (SplitMix64).
class SplitMix64 {
 public:
  explicit SplitMix64(int64_t seed) : state_(static_cast<uint64_t>(seed)) {}
  double uniform(double lower, double upper);

 private:
  uint64_t state_;
};

/// Finds ways in joint space and time that keep clear of the obstacles as they move now: straight to a posture that has
/// the target and can stay there, or by way of another one.
class Planner {
 public:
  explicit Planner(const Model& model) : model_(model), random_(model.settings.foresight.seed) {}

  /// Forgets what was thrown so far.
  void start_over() { random_ = SplitMix64(model_.settings.foresight.seed); }

  /// Tries a few random ways and returns the one that arrives soonest; without knots when all fail. Bounded.
  Guide to_target(const Snapshot& from);

  /// Likewise to a place nearby where nothing will come, outlook kWaiting.
  Guide to_safety(const Snapshot& from);

 private:
  JointVector random_configuration(const JointVector& around_rad, double reach_rad);
  bool is_clear(const Snapshot& from, const Guide& guide) const;
  void append(Guide& guide, const JointVector& q_rad) const;

  const Model& model_;
  SplitMix64 random_;
};

}  // namespace sidestep
