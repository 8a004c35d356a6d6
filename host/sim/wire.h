#pragma once

#include <memory>
#include <optional>
#include <string>

#include "host/sim/answer.h"
#include "host/sim/joints.h"
#include "host/sim/place.h"
#include "host/sim/world.h"

namespace sidestep::sim {

/// One message of the controller of an arm.
struct Heard {
  size_t arm;
  Answer answer;
};

/// The simulator's end of the wire: TARGET, OBSTACLES and ARM_STATE out, ARM_COMMAND and CONTROLLER_STATUS in, for each
/// of its arms.
class Bus {
 public:
  /// url: of LCM, empty for LCM's default. log_file: where to keep all messages in lcm-logger's format, empty for
  /// nowhere. Throws std::runtime_error when either cannot be opened.
  Bus(const std::string& url, const std::string& log_file, const std::vector<Channels>& arms);
  ~Bus();

  /// TARGET, then OBSTACLES.
  void publish(size_t arm, const World& world, int64_t utime);
  void publish(size_t arm, const Target& target, int64_t utime);
  void publish(size_t arm, const std::vector<Obstacle>& obstacles, int64_t utime);
  /// ARM_STATE.
  void publish(size_t arm, const JointVector& q_rad, const JointVector& qd_radps, int64_t utime);

  /// The oldest message not yet taken; waits up to wait_us for one, but never longer than 0.1 s. Nothing on a time-out,
  /// a signal, or a message that is none: that one is counted.
  std::optional<Heard> next(int64_t wait_us);

  int64_t malformed() const;
  /// False once a message could not be written to the log.
  bool log_good() const;

 private:
  struct Wire;
  std::unique_ptr<Wire> wire_;
};

}  // namespace sidestep::sim
