#pragma once

#include <cstdint>

namespace sidestep {

/// Time between the sending of two messages, s: the difference of their utimes, but at most the time between their
/// receipts plus slack_s, since no network delays a message longer than that. utime in microseconds.
double sent_apart_s(int64_t utime, int64_t later_utime, double received_apart_s, double slack_s);

/// Decides by utime whether a message of one channel is newer than all messages accepted before it.
class MessageOrder {
 public:
  /// Accepts a newer utime and drops a repeated one. Drops an older one, unless its sender has restarted: nothing was
  /// accepted for `restart_s` (local receipt times, s), or it is the third in a row, increasing, that is older by more
  /// than `restart_s`. A message that is merely late arrives between newer ones and is dropped.
  bool accept(int64_t utime, double now_s, double restart_s);

  /// For a message that was not accepted: it is older than the newest one, not a repetition of it.
  bool is_late(int64_t utime) const { return any_ && utime < utime_; }

  /// Time between the last two accepted messages, s: the larger of the times by receipt and by the sender's clock, the
  /// latter with `restart_s` of slack. 0 for the first message.
  double elapsed_s() const { return elapsed_s_; }

 private:
  bool has_restarted(int64_t utime, double now_s, double restart_s);

  bool any_ = false;
  int64_t utime_ = 0;
  int64_t old_utime_ = 0;  ///< of the last message that was older by more than restart_s
  int old_in_a_row_ = 0;   ///< such messages since the last accepted one
  double accepted_s_ = 0.0;
  double elapsed_s_ = 0.0;
};

}  // namespace sidestep
