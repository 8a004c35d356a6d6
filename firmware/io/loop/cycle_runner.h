#pragma once

#include <cmath>

#include "firmware/foresight/foresight_thread.h"
#include "firmware/io/blackbox/blackbox.h"
#include "firmware/io/lcm/wire.h"
#include "firmware/io/loop/cycle_clock.h"

namespace sidestep {

/// Runs one cycle after the other: calls step(), publishes command, report and timing, records the cycle in the
/// blackbox and hands it to foresight. Both loops own one.
class CycleRunner {
 public:
  /// degraded: Limiting bits that hold for every cycle, such as kLimitingNotRealtime. All arguments outlive this.
  CycleRunner(const Config& config, Wire& wire, Blackbox& blackbox, ForesightThread& foresight_thread, bool lockstep,
              int degraded);

  /// When and why a cycle runs.
  struct CycleTrigger {
    double now_s = 0.0;
    int64_t utime = 0;
    int skipped_cycles = 0;  ///< since the previous one
    double wake_latency_s = 0.0;
    bool stop = false;
    double foreign_command_s = -HUGE_VAL;  ///< as in Inputs
    int64_t rejected_messages = 0;
    const char* rejected_reason = "";
  };
  void run(const LatestInputs& latest, const CycleTrigger& trigger);

  /// No command moves the arm.
  bool at_rest() const { return state_.stream.at_rest(); }

  const LoopTiming& timing() const { return timing_; }

 private:
  void publish_timing(const CycleTrigger& trigger);
  /// The reason of the last rejection while it is recent, else "".
  const char* reason_to_show(const CycleTrigger& trigger);

  const Model& model_;
  Wire& wire_;
  Blackbox& blackbox_;
  ForesightThread& foresight_thread_;
  bool lockstep_;
  int degraded_;
  State state_;
  LoopTiming timing_;
  CycleClock clock_{timing_};
  double timing_published_s_ = 0.0;
  int64_t rejected_messages_ = 0;
  double rejected_s_ = -HUGE_VAL;
};

}  // namespace sidestep
