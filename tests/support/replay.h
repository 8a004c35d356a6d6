#pragma once

#include <string>
#include <vector>

namespace sidestep::test {

/// Result of build/replay for a log.
struct Replay {
  int code;
  std::string output;
};

Replay replay(const std::string& log, const std::vector<std::string>& more = {});

/// Replays a log and returns the number of cycles; fails the test unless all agree bit for bit.
int agreeing_cycles(const std::string& log);

/// The complete logs in a folder that were written for this reason, the oldest first. A pause of the machine is also a
/// fault and may add a log that the test did not cause.
std::vector<std::string> logs_in(const std::string& folder, const std::string& reason);

}  // namespace sidestep::test
