#pragma once

#include <cmath>

#include "firmware/foresight/foresight_thread.h"
#include "firmware/io/blackbox/blackbox.h"
#include "firmware/io/lcm/wire.h"

namespace sidestep {

/// Runs cycle after cycle: step(), its command and report onto the wire, its times into the books, all of it into the
/// blackbox. Each of the two loops owns one.
class CycleRunner {
 public:
  /// standing: what limits every cycle (bits of Limiting). All arguments outlive this.
  CycleRunner(const Config& config, Wire& wire, Blackbox& blackbox, ForesightThread& foresight_thread, bool lockstep,
              int standing);

  /// When and how a cycle takes place.
  struct CycleTrigger {
    double now_s = 0.0;
    int64_t utime = 0;
    int skipped_cycles = 0;  ///< since the one before
    double wake_latency_s = 0.0;
    bool stop = false;
    double foreign_command_s = -HUGE_VAL;  ///< as in Inputs
    int64_t rejected_messages = 0;
    const char* rejected_reason = "";
  };
  void run(const LatestInputs& post, const CycleTrigger& trigger);

  /// Nothing moves by command.
  bool at_rest() const { return sidestep::at_rest(state_); }

  const Timing& timing() const { return timing_; }

 private:
  void publish_timing(const CycleTrigger& trigger);
  /// Why the last message was rejected, for a while.
  const char* reason_to_show(const CycleTrigger& trigger);

  const Model& model_;
  Wire& wire_;
  Blackbox& blackbox_;
  ForesightThread& foresight_thread_;
  bool lockstep_;
  int standing_;
  State state_;
  Timing timing_;
  CycleClock clock_{timing_};
  double timing_published_s_ = 0.0;
  int64_t rejected_messages_ = 0;
  double rejected_s_ = -HUGE_VAL;
};

}  // namespace sidestep
