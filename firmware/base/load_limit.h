#pragma once

#include <algorithm>

namespace sidestep {

/// Bounds the CPU time of a thread that works in pieces (a token bucket): in any span of time the share of one core,
/// and beyond that at most the burst and one piece.
class LoadLimit {
 public:
  /// share: of one core, above 0; burst_s: CPU time that may be used at once after a rest; now_s: on a monotonic clock.
  /// The thread has used no CPU time.
  LoadLimit(double share, double burst_s, double now_s)
      : share_(share), burst_s_(burst_s), credit_s_(burst_s), at_s_(now_s) {}

  /// After a piece of work: the earliest start of the next one. used_s: all CPU time of the thread, s.
  double next_start_s(double now_s, double used_s) {
    credit_s_ = std::min(burst_s_, credit_s_ + share_ * (now_s - at_s_)) - (used_s - used_s_);
    at_s_ = now_s;
    used_s_ = used_s;
    return now_s + std::max(0.0, -credit_s_ / share_);
  }

 private:
  double share_, burst_s_;
  double credit_s_;  ///< CPU time that may be used at once; negative: to be earned first
  double at_s_, used_s_ = 0.0;
};

}  // namespace sidestep
