#pragma once

#include <atomic>
#include <string>

#include "firmware/io/config/config.h"
#include "firmware/io/loop/timing.h"

namespace sidestep {

/// What may be asked of a running loop, by a signal handler, too.
struct Requests {
  std::atomic<bool> stop{false};
  std::atomic<bool> write_blackbox{false};
};

/// What a run was like.
struct LoopSummary {
  Timing timing;
  int64_t rejected_messages = 0;
};

/// Runs the controller on the monotonic clock, Settings::rate_hz cycles a second, until asked to stop; then brakes to
/// rest. A thread of its own receives, another writes blackbox logs. Warns when real time is not permitted.
LoopSummary run_realtime(const Config& config, const std::string& lcm_url, Requests& requests);

/// Runs one cycle for every arm state received, on the arm's clock, until asked to stop; then brakes to rest if arm
/// states still come. Receives and computes in one thread, in the order of arrival: deterministic.
LoopSummary run_lockstep(const Config& config, const std::string& lcm_url, Requests& requests);

}  // namespace sidestep
