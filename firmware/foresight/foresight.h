#pragma once

#include "firmware/foresight/planner.h"
#include "firmware/foresight/rollout.h"

namespace sidestep {

/// Whether these settings want foresight: it is on, and the law follows guides.
bool foresees(const Settings& settings);

/// Looks ahead, finds that the law will not arrive or not stay, and finds a way that does. Large: lives on the heap.
class Foresight {
 public:
  explicit Foresight(const Model& model) : model_(model), rollout_(model), planner_(model) {}

  /// One call a cycle, of bounded work: judges the guide of the calls before, or looks for a better one. The guide is
  /// for the cycles that follow. The same snapshots give the same guides.
  const Guide& update(const Snapshot& now);

 private:
  void judge(const Snapshot& now);
  void search(const Snapshot& now);
  void take(const Guide& guide, const Forecast& forecast);

  const Model& model_;
  Rollout rollout_;
  Planner planner_;
  int64_t calls_ = 0;
  Guide guide_;
  Forecast expected_;  ///< under the guide
  Guide candidate_;    ///< a way that looks clear, not yet played
  int searching_ = 0;  ///< calls in vain
};

}  // namespace sidestep
