#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host/sim/record.h"

namespace sidestep::sim {

/// The line on stderr with the progress of a simulation. On a terminal it is rewritten ten times a second. Elsewhere a
/// new line is printed every second, and none in lockstep, where a simulation takes only a few seconds.
class ProgressLine {
 public:
  ProgressLine(bool quiet, bool lockstep);

  /// Before t = 0.
  void show_waiting(const std::string& for_what);

  /// From t = 0 on; one row per arm. duration_s: 0 when endless.
  void show_running(const std::vector<const Row*>& arms, double duration_s);
  /// Ends the line, so that later output starts on a new line.
  void end();

 private:
  bool due();
  void show(const std::string& line);

  bool terminal_;
  int64_t every_us_;  ///< 0: the line is never shown
  int64_t next_us_ = 0;
  bool shown_ = false;
};

}  // namespace sidestep::sim
