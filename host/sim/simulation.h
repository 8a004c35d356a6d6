#pragma once

#include <atomic>

#include "host/sim/progress_line.h"
#include "host/sim/run.h"
#include "host/sim/wire.h"

namespace sidestep::sim {

enum class Outcome { kDone, kInterrupted, kNeverTracked, kLost };

/// A controller that sends no message for this time is lost.
constexpr int64_t kLostAfter_us = 5'000'000;

/// The runs of all arms of a scenario, on one clock. t = 0 is the first period in which all runs are ready().
class Simulation {
 public:
  /// At least one run; runs[k] uses the channels of arm k of the wire.
  Simulation(std::vector<Run> all, const ProgressLine& progress) : runs(std::move(all)), progress_(progress) {}

  bool answered() const;  ///< every controller has sent a status
  bool ready() const;     ///< every run is
  bool tracked() const { return runs.front().tracked(); }
  bool complete() const { return runs.front().complete(); }

  /// Records the coming period of all arms, each after measure().
  void record();

  /// Before t = 0: the progress line shows waits_for().
  void show_waiting() { progress_.show_waiting(waits_for()); }
  std::string waits_for() const;
  void end_progress() { progress_.end(); }

  /// The scenario of the first arm; times are the same for all arms.
  const Scenario& scenario() const { return runs.front().scenario(); }

  std::vector<Run> runs;

 private:
  ProgressLine progress_;
};

/// Runs on the arms' clock. In each period each arm in turn sends TARGET, OBSTACLES and ARM_STATE and waits for the
/// command with the same utime. Returns kNeverTracked when tracking takes longer than patience_s, on the monotonic
/// clock until all controllers have answered and on the arms' clock from then on.
Outcome run_lockstep(Simulation& simulation, SimWire& wire, double patience_s, const std::atomic<bool>& interrupted);

/// Runs on the monotonic clock; t = 0 is the arrival of the status with which all runs are ready().
Outcome run_realtime(Simulation& simulation, SimWire& wire, double patience_s, const std::atomic<bool>& interrupted);

}  // namespace sidestep::sim
