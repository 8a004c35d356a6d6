#pragma once

#include <array>

#include "firmware/base/histogram.h"
#include "firmware/control/stages.h"

namespace sidestep {

/// What was lost on the way in, since the start.
struct Reception {
  int64_t lost_datagrams = 0;       ///< dropped by the kernel because the receive buffer was full
  int64_t malformed_datagrams = 0;  ///< not LCM's, or with impossible sizes
  int64_t incomplete_messages = 0;  ///< discarded because a fragment was missing or wrong
};

/// Times of a loop since its start; published as loop_timing_t.
struct LoopTiming {
  double period_s = 0.0;
  bool realtime = false;  ///< FIFO scheduling and locked memory were permitted
  int64_t cycles = 0;
  int64_t skipped_cycles = 0;
  Histogram wake_latency;                 ///< from the intended instant to the first instruction; empty in lockstep
  Histogram cycle;                        ///< CPU time of a cycle until its command is sent
  std::array<Histogram, kStages> stages;  ///< CPU time, by Stage
  Reception reception;
};

}  // namespace sidestep
