#pragma once

#include <string>

#include "firmware/base/histogram.h"
#include "firmware/control/stages.h"

namespace sidestep {

/// Where the time of a loop went since its start.
struct Timing {
  double period_s = 0.0;
  bool realtime = false;  ///< FIFO scheduling and locked memory were permitted
  int64_t cycles = 0;
  int64_t skipped_cycles = 0;
  Histogram wake_latency;                 ///< from the instant asked for to the first instruction; none in lockstep
  Histogram cycle;                        ///< CPU time up to the command's departure
  std::array<Histogram, kStages> stages;  ///< CPU time, by Stage
};

/// A few lines for people: 50, 99 and 99.9 % and the worst of each, us.
std::string table(const Timing& timing);

/// The CPU clock of the thread that runs the cycles, read at the end of every stage.
class CycleClock : public StageProbe {
 public:
  explicit CycleClock(Timing& timing) : timing_(timing) {}

  void start();
  void passed(Stage stage) override;
  double stop();  ///< CPU time since start(), s

 private:
  Timing& timing_;
  double start_s_ = 0.0;
  double passed_s_ = 0.0;
};

}  // namespace sidestep
