#pragma once

#include "firmware/foresight/planner.h"
#include "firmware/foresight/rollout.h"

namespace sidestep {

/// Detects by rollouts that the law would not arrive at the target or would collide, and searches for a guide that
/// arrives. Large: lives on the heap.
class Foresight {
 public:
  explicit Foresight(const Model& model) : model_(model), rollout_(model), planner_(model) {}

  /// One call per snapshot, of bounded work: at most two rollouts, or two plans. Every fifth call assesses the present
  /// guide, and drops it if the law alone is better. While the assessment is not good, the other calls alternate
  /// between a search for a candidate and its rollout; a candidate that costs at least 0.5 s less becomes the guide.
  /// After more than 50 searches without a plan, the status is kWaiting if there is no guide and no arrival expected.
  /// Returns the guide for the following cycles. A snapshot that is not tracking resets everything. The same sequence
  /// of snapshots gives the same guides.
  const Guide& update(const Snapshot& now);

 private:
  void reset();
  void assess(const Snapshot& now);
  void search(const Snapshot& now);
  void adopt(const Guide& guide, const Forecast& forecast);

  const Model& model_;
  Rollout rollout_;
  Planner planner_;
  int64_t calls_ = 0;
  Guide guide_;
  Forecast expected_;              ///< under guide_
  Guide candidate_;                ///< a plan that has no rollout yet; no knots: none
  int unsuccessful_searches_ = 0;  ///< since the guide was last changed or assessed as good
};

}  // namespace sidestep
