#pragma once

#include "firmware/control/types/messages.h"
#include "firmware/control/types/settings.h"

namespace sidestep {

/// Whether the values of a message can be true: finite, within what any arm or room can be, unit quaternions.
bool plausible(const ArmState& state, int joints);
bool plausible(const Target& target);
bool plausible(const Obstacle& obstacle);

/// The newest valid message of one channel, when it was received and how many there have been.
template <typename Message>
struct Latest {
  const Message* message = nullptr;  ///< null: none yet
  double received_s = 0.0;
  int64_t count = 0;

  double age_s(double now_s) const { return now_s - received_s; }
  bool fresh(double now_s, double limit_s) const { return message && age_s(now_s) >= 0.0 && age_s(now_s) <= limit_s; }
};

/// From one message to another by their sender's clock, s, as far as that agrees with how far apart they were received:
/// no network holds a message back for longer than slack_s.
double sent_apart_s(int64_t utime, int64_t later_utime, double received_apart_s, double slack_s);

/// Decides by its utime whether a message is newer than all before it on its channel.
class Order {
 public:
  /// Accepts a newer utime. An older one is dropped unless its sender has evidently started anew: nothing was accepted
  /// for `restart_s` (local receipt times, s), or it is the last of three in a row that are older by more than that; a
  /// message that is merely late comes among newer ones. A repeated utime is always dropped: a sender that has frozen
  /// says nothing new.
  bool accept(int64_t utime, double now_s, double restart_s);

  /// Whether a message that was not accepted is older than the newest, not the same once more.
  bool is_late(int64_t utime) const { return any_ && utime < utime_; }

  /// From the message accepted before the last to the last, s, by their receipt; by their sender's clock where that
  /// says more, with `restart_s` of slack. 0 for the first.
  double elapsed_s() const { return elapsed_s_; }

 private:
  static constexpr int kAnewInARow = 3;
  bool starts_anew(int64_t utime, double now_s, double restart_s);

  bool any_ = false;
  int64_t utime_ = 0;
  int64_t anew_utime_ = 0;  ///< of the last one that was far back
  int anew_in_a_row_ = 0;   ///< those with nothing accepted in between
  double accepted_s_ = 0.0;
  double elapsed_s_ = 0.0;
};

}  // namespace sidestep
