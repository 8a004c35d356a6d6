#pragma once

#include <string>
#include <vector>

namespace sidestep::test {

/// What build/replay made of a log.
struct Replay {
  int code;
  std::string output;
};

Replay replay(const std::string& log, const std::vector<std::string>& more = {});

/// Cycles that agree, as the replay says it; fails the test unless all do, bit for bit.
int agreed(const std::string& log);

/// The logs of a folder that are complete and were written for this reason, the oldest first. A pause of the machine is
/// a fault, too, and may leave one that no test asked for.
std::vector<std::string> logs_in(const std::string& folder, const std::string& reason);

}  // namespace sidestep::test
