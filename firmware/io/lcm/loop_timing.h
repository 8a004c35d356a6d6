#pragma once

#include <array>

#include "firmware/base/histogram.h"
#include "firmware/control/stages.h"

namespace sidestep {

/// Times of a loop since its start; published as loop_timing_t.
struct LoopTiming {
  double period_s = 0.0;
  bool realtime = false;  ///< FIFO scheduling and locked memory were permitted
  int64_t cycles = 0;
  int64_t skipped_cycles = 0;
  Histogram wake_latency;                 ///< from the intended instant to the first instruction; empty in lockstep
  Histogram cycle;                        ///< CPU time of a cycle until its command is sent
  std::array<Histogram, kStages> stages;  ///< CPU time, by Stage
};

}  // namespace sidestep
