#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "firmware/io/config/config.h"

namespace sidestep {

/// What running the cycles of a blackbox log again has shown.
struct Comparison {
  int64_t cycles = 0;     ///< run
  int64_t commands = 0;   ///< that the log holds
  int64_t different = 0;  ///< cycles with another command, or one where there was none, or none where there was one
  int64_t first_different_seq = 0;
};

/// A blackbox log, opened and its first message read. Throws std::runtime_error, one line that names the file, for
/// anything that is no whole log of a blackbox of this build; so does replay().
class BlackboxLog {
 public:
  explicit BlackboxLog(const std::string& file);
  ~BlackboxLog();

  /// How the controller was started, and what led to the log.
  std::string config_file() const;
  Overrides overrides() const;
  std::string reason() const;

  /// Runs step() over all cycles, from the state that the first one was given on, and compares the commands byte by
  /// byte. To be called once.
  Comparison replay(const Config& config);

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

}  // namespace sidestep
