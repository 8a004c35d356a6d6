#pragma once

#include <atomic>

#include "host/sim/live.h"
#include "host/sim/run.h"
#include "host/sim/wire.h"

namespace sidestep::sim {

enum class End { kDone, kInterrupted, kNeverTracked, kLost };

/// Without an answer for this long a controller is lost.
constexpr int64_t kLostAfterUs = 5'000'000;

/// All arms of a scenario on one clock. t = 0 is when all of them track.
class Play {
 public:
  /// At least one; bus.arm k is runs[k].
  Play(std::vector<Run> all, const Live& live) : runs(std::move(all)), live_(live) {}

  bool answered() const;  ///< every controller has said something
  bool tracking() const;  ///< and what it said last is that it tracks
  bool tracked() const { return runs.front().tracked(); }
  bool complete() const { return runs.front().complete(); }

  /// Keeps the coming period of all arms; they have been measured.
  void record();

  /// Says before t = 0 what is being waited for.
  void show_waiting() { live_.waiting(waits_for()); }
  std::string waits_for() const;
  void end_live() { live_.end(); }

  /// Of the first arm: the clock is the same for all.
  const Scenario& scenario() const { return runs.front().scenario(); }

  std::vector<Run> runs;

 private:
  Live live_;
};

/// Plays on the arms' clock: in each period each arm in turn sends TARGET, OBSTACLES and ARM_STATE and waits for the
/// answer to exactly these. Gives up when tracking takes longer than patience_s, before the first answers on the wall's
/// clock, then on the arms'.
End run_lockstep(Play& play, Bus& bus, double patience_s, const std::atomic<bool>& interrupted);

/// Plays on the monotonic clock; t = 0 is the arrival of the status that completes the tracking.
End run_realtime(Play& play, Bus& bus, double patience_s, const std::atomic<bool>& interrupted);

}  // namespace sidestep::sim
