#pragma once

#include <string>

#include "firmware/io/lcm/loop_timing.h"

namespace sidestep {

/// A table for people: 50, 99, 99.9 % and the largest of each time, us.
std::string table(const LoopTiming& timing);

/// Measures the CPU time of the thread that runs the cycles, stage by stage.
class CycleClock : public StageProbe {
 public:
  explicit CycleClock(LoopTiming& timing) : timing_(timing) {}

  void start();
  void passed(Stage stage) override;
  double stop();  ///< CPU time since start(), s

 private:
  LoopTiming& timing_;
  double start_s_ = 0.0;
  double passed_s_ = 0.0;
};

}  // namespace sidestep
