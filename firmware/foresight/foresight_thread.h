#pragma once

#include <atomic>
#include <thread>

#include "firmware/base/triple_buffer.h"
#include "firmware/foresight/foresight.h"

namespace sidestep {

/// Foresight beside the loop. On a thread of its own it thinks once for the newest cycle, not more than a hundred times
/// a second; in lockstep within tell(), so that runs are deterministic. The loop waits for neither.
class ForesightThread {
 public:
  /// To be made by a thread without real-time priority: its own inherits that. The model outlives this.
  ForesightThread(const Model& model, bool lockstep);
  ~ForesightThread();

  /// Loop: the guide to follow now; null without foresight. Stays as it is until the next call.
  const Guide* latest();

  /// Loop: what the cycle was told and where it led.
  void tell(const Inputs& inputs, const State& state, double now_s);

 private:
  void think();
  void attend();

  const Model& model_;
  bool on_;
  std::unique_ptr<Foresight> foresight_;
  TripleBuffer<Snapshot> snapshots_;
  TripleBuffer<Guide> guides_;
  double thought_of_s_ = 0.0;
  std::atomic<bool> end_{false};
  std::thread thinking_;
};

}  // namespace sidestep
