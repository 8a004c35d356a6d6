#pragma once

#include <atomic>
#include <memory>
#include <thread>

#include "firmware/base/triple_buffer.h"
#include "firmware/foresight/foresight.h"

namespace sidestep {

/// Runs foresight for a loop. In real time: on a thread of its own, one update for the newest cycle, at most 100 times
/// a second and with at most a fifth of one core; the loop exchanges snapshots and guides with it through triple
/// buffers and never waits. In lockstep: one update within each submit(), so that runs are deterministic; then the
/// caller does the work itself.
class ForesightThread {
 public:
  /// To be called from a thread without real-time priority: the new thread inherits the priority of its creator. The
  /// model outlives this.
  ForesightThread(const Model& model, bool lockstep);
  ~ForesightThread();

  /// Loop: the guide to follow now; null with foresight switched off. Valid and unchanged until the next call.
  const Guide* latest();

  /// Loop: the inputs of a cycle and the state that it led to. Takes the snapshot on the calling thread.
  void submit(const Inputs& inputs, const State& state, double now_s);

 private:
  void update();
  void run();

  const Model& model_;
  const bool enabled_;
  std::unique_ptr<Foresight> foresight_;
  TripleBuffer<Snapshot> snapshots_;
  TripleBuffer<Guide> guides_;
  double updated_for_s_ = 0.0;  ///< time of the snapshot of the last update
  std::atomic<bool> end_{false};
  std::thread thread_;
};

}  // namespace sidestep
