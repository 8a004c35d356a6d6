#pragma once

#include <memory>
#include <optional>
#include <string>

#include "host/sim/answer.h"
#include "host/sim/joints.h"
#include "host/sim/world.h"

namespace sidestep::sim {

/// The simulator's end of the wire: TARGET, OBSTACLES and ARM_STATE out, ARM_COMMAND and CONTROLLER_STATUS in.
class Bus {
 public:
  /// url: of LCM, empty for LCM's default. log_file: where to keep all messages in lcm-logger's format, empty for
  /// nowhere. Throws std::runtime_error when either cannot be opened.
  Bus(const std::string& url, const std::string& log_file);
  ~Bus();

  /// TARGET, then OBSTACLES.
  void publish(const World& world, int64_t utime);
  void publish(const Target& target, int64_t utime);
  void publish(const std::vector<Obstacle>& obstacles, int64_t utime);
  /// ARM_STATE.
  void publish(const JointVector& q_rad, const JointVector& qd_radps, int64_t utime);

  /// The oldest message not yet taken; waits up to wait_us for one, but never longer than 0.1 s. Nothing on a time-out,
  /// a signal, or a message that is none: that one is counted.
  std::optional<Answer> next(int64_t wait_us);

  int64_t malformed() const;
  /// False once a message could not be written to the log.
  bool log_good() const;

 private:
  struct Wire;
  std::unique_ptr<Wire> wire_;
};

}  // namespace sidestep::sim
