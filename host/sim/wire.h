#pragma once

#include <memory>
#include <optional>
#include <string>

#include "host/sim/arm_setup.h"
#include "host/sim/controller_message.h"
#include "host/sim/joints.h"
#include "host/sim/world.h"

namespace sidestep::sim {

/// One message from the controller of an arm.
struct ReceivedMessage {
  size_t arm;
  ControllerMessage message;
};

/// The simulator's LCM connection: sends TARGET or JOINT_TARGET, OBSTACLES, ATTACHMENTS and ARM_STATE, receives
/// ARM_COMMAND and CONTROLLER_STATUS, for each of its arms.
class SimWire {
 public:
  /// url: of LCM, empty for LCM's default. log_file: log of all messages in lcm-logger's format, empty for none. Throws
  /// std::runtime_error when either cannot be opened.
  SimWire(const std::string& url, const std::string& log_file, const std::vector<Channels>& arms);
  ~SimWire();

  /// What the world lacks comes from other processes. Their messages are logged. Obstacles: publish() sends the empty
  /// set, which states that there are none, only while nobody else has sent any for 1 s.
  void leave_to_others(size_t arm, const World& world);

  /// TARGET or JOINT_TARGET if there is one, OBSTACLES and, where something is grasped, ATTACHMENTS.
  void publish(size_t arm, const World& world, int64_t utime);
  void publish(size_t arm, const Target& target, int64_t utime);
  void publish(size_t arm, const std::vector<Obstacle>& obstacles, int64_t utime);
  void publish(size_t arm, const Grip& grip, int64_t utime);
  /// ARM_STATE.
  void publish(size_t arm, const JointVector& q_rad, const JointVector& qd_radps, int64_t utime);

  /// The oldest message in the queue. Waits for one up to wait_us, at most 0.1 s. Returns nothing on a time-out, a
  /// signal or a malformed message, which is counted.
  std::optional<ReceivedMessage> next(int64_t wait_us);

  int64_t malformed() const;
  /// False once a message could not be written to the log.
  bool log_good() const;

 private:
  struct Network;
  std::unique_ptr<Network> network_;
};

}  // namespace sidestep::sim
