#pragma once

#include <chrono>

#include "firmware/model/arm.h"
#include "tests/support/command_check.h"
#include "tests/support/lcm_peer.h"

namespace sidestep::test {

/// Real-time model of an ideal arm, a target and an obstacle over LCM with 100 ticks a second. All commands are
/// checked. Public members may be changed at any time. Without a command for five ticks the arm stops by itself. The
/// next command must then continue from there, unless the controller had sent it in time: it continues the last
/// command.
class LiveArm {
 public:
  /// period_s: of the commands.
  LiveArm(const JointLimits& limits, const JointVector& start_rad, double period_s = 0.01);

  bool sends_arm_state = true, sends_target = true, sends_obstacles = true;  ///< which messages are sent
  Vector3 target_m = Vector3::Zero();
  int64_t clock_offset_us = 0;  ///< of all utimes
  LcmPeer peer;
  CommandCheck commands;

  void run(double duration_s);
  /// Runs until the last status has this mode, for at most limit_s. Returns whether it has.
  bool run_until(int8_t mode, double limit_s);

  const controller_status_t& status() const { return peer.statuses.back(); }
  /// Whether the last status message contains the text.
  bool reports(const char* text) const;
  double speed_radps() const;  ///< of the last command
  /// Number of commands that the network dropped; the check continues after them.
  int64_t lost() const { return lost_; }

 private:
  void tick();
  void follow();
  void stop_by_itself();
  int64_t silent_between(int64_t one, int64_t other) const;

  JointLimits limits_;
  double period_s_;
  JointVector position_rad_, velocity_radps_;
  std::chrono::steady_clock::time_point next_;
  size_t followed_ = 0;
  int ticks_without_command_ = 0;
  bool stopped_by_itself_ = false;
  int64_t lost_ = 0;
};

}  // namespace sidestep::test
