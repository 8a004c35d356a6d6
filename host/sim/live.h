#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host/sim/record.h"

namespace sidestep::sim {

/// The line on stderr that tells how a run goes: rewritten ten times a second on a terminal, else a new line every
/// second, and none of those in lockstep, where a run is over before one would be read.
class Live {
 public:
  Live(bool quiet, bool lockstep);

  /// Before t = 0.
  void waiting(const std::string& for_what);
  void running(const std::vector<const Row*>& arms, double duration_s);
  /// Nothing more comes: what is printed next starts on a line of its own.
  void end();

 private:
  bool due();
  void show(const std::string& line);

  bool terminal_;
  int64_t every_us_;  ///< 0: never
  int64_t next_us_ = 0;
  bool shown_ = false;
};

}  // namespace sidestep::sim
