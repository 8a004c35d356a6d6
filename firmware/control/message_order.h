#pragma once

#include <cstdint>

namespace sidestep {

/// Time between the sending of two messages, s, estimated as min(difference of their utimes, received_apart_s +
/// slack_s). The network may have delayed one of them by slack_s more than the other. A larger difference of the utimes
/// can only be a jump of the sender's clock. utime: microseconds.
double sent_apart_s(int64_t utime, int64_t later_utime, double received_apart_s, double slack_s);

/// Decides by utime whether a message of one channel is newer than all messages accepted before it.
class MessageOrder {
 public:
  /// Accepts a newer utime. Drops a repeated one, and an older one unless its sender has restarted. A restart is
  /// assumed
  ///   - when nothing was accepted for restart_s, or
  ///   - after three messages in a row whose utimes increase and are all older than the newest accepted one by more
  ///     than restart_s. (Three, because single messages of a running sender may be late.)
  /// now_s: local time of receipt. restart_s: the timeout of the channel.
  bool accept(int64_t utime, double now_s, double restart_s);

  /// For a message that was not accepted: it is older than the newest one, not a repetition of it.
  bool is_late(int64_t utime) const { return any_ && utime < utime_; }

  /// Time between the last two accepted messages, s: max(received_apart_s, sent_apart_s(..., restart_s)), so as not to
  /// underestimate what can have changed between them. 0 for the first message.
  double elapsed_s() const { return elapsed_s_; }

  /// Time between the sending of the last two accepted messages, s: that of the sender's clock, without the jitter of
  /// the network. In the mean it is the time between their receipts, whatever the sender's clock does. 0 for the first.
  double sending_interval_s() const { return sending_interval_s_; }

 private:
  bool has_restarted(int64_t utime, double now_s, double restart_s);
  void follow_clock(int64_t utime, double by_receipt_s, double slack_s);

  bool any_ = false;
  int64_t utime_ = 0;
  int64_t old_utime_ = 0;  ///< of the last message that was older by more than restart_s
  int old_in_a_row_ = 0;   ///< such messages since the last accepted one
  double accepted_s_ = 0.0;
  double elapsed_s_ = 0.0;
  double sending_interval_s_ = 0.0;
  double lead_s_ = 0.0;  ///< by how much the sender's clock is ahead of the receipts, less the mean
};

}  // namespace sidestep
