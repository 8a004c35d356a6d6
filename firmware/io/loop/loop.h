#pragma once

#include <atomic>
#include <string>

#include "firmware/io/config/config.h"
#include "firmware/io/lcm/loop_timing.h"

namespace sidestep {

/// Requests to a running loop; a signal handler may set them.
struct Requests {
  std::atomic<bool> stop{false};
  std::atomic<bool> write_blackbox{false};
};

struct LoopSummary {
  LoopTiming timing;
  int64_t rejected_messages = 0;
  Reception reception;
};

/// Runs the controller on the monotonic clock, Settings::rate_hz cycles a second, until a stop is requested; then
/// brakes to rest. One thread runs the cycles, one receives, one runs foresight and one writes blackbox logs. Warns
/// where real-time scheduling or locked memory is not permitted.
LoopSummary run_realtime(const Config& config, const std::string& lcm_url, Requests& requests);

/// Runs one cycle for every arm state received, on the arm's clock, until a stop is requested; then brakes to rest
/// while arm states still arrive. One thread receives and computes, in the order of arrival, so that runs are
/// deterministic.
LoopSummary run_lockstep(const Config& config, const std::string& lcm_url, Requests& requests);

}  // namespace sidestep
