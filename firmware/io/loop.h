#pragma once

#include <atomic>
#include <string>

#include "firmware/io/config.h"

namespace sidestep {

/// What a run of the loop was like, for the line printed at its end.
struct LoopSummary {
  int64_t cycles = 0;
  int64_t skipped_cycles = 0;
  int64_t rejected_messages = 0;
  double cpu_mean_s = 0.0;  ///< of one cycle
  double cpu_worst_s = 0.0;
  double wake_latency_worst_s = 0.0;
};

/// Runs the controller on the monotonic clock, Settings::rate_hz cycles a second, until `stop`; then brakes to rest.
/// A thread of its own receives; the two share nothing but mailboxes. Warns when real time is not permitted.
LoopSummary run_realtime(const Config& config, const std::string& lcm_url, const std::atomic<bool>& stop);

/// Runs one cycle for every arm state received, on the arm's clock, until `stop`; then brakes to rest if arm states
/// still come. All in one thread, in the order of arrival: deterministic.
LoopSummary run_lockstep(const Config& config, const std::string& lcm_url, const std::atomic<bool>& stop);

}  // namespace sidestep
