#pragma once

#include <chrono>
#include <drake/lcmt_iiwa_command.hpp>
#include <drake/lcmt_iiwa_status.hpp>

#include "tests/support/command_check.h"
#include "tests/support/lcm_peer.h"

namespace sidestep::test {

/// A status as drake-iiwa-driver sends it; values that it does not have are NaN.
drake::lcmt_iiwa_status iiwa_status(int64_t utime, const JointVector& measured_rad, const JointVector& velocity_radps,
                                    const JointVector& commanded_rad);

/// Real-time model of drake-iiwa-driver with an arm, a target and an obstacle, on this process's network. Sends 200
/// statuses a second, the first 200 of them without a time. Stops on a command within 250 ms of its first status. Holds
/// the last commanded position for ever; the measured position is 0.01 rad below the commanded one.
class IiwaDriver {
 public:
  IiwaDriver(const JointLimits& limits, const JointVector& start_rad, const Vector3& target_m);

  Vector3 target_m;
  LcmPeer peer;
  CommandCheck commands;
  std::string stop_reason;  ///< why the driver has stopped; empty while it runs

  void run(double duration_s);
  /// Runs until the controller's last status has this mode, for at most limit_s. Returns whether it has.
  bool run_until(int8_t mode, double limit_s);

  /// Stops the driver for a while, then starts it again at the arm's position.
  void restart(double silence_s);

  const JointVector& held_rad() const { return held_rad_; }
  double speed_radps() const { return velocity_radps_.norm(); }

 private:
  using Clock = std::chrono::steady_clock;
  void tick();
  void send_status();
  void on_command(const lcm::ReceiveBuffer* buffer, const std::string& channel,
                  const drake::lcmt_iiwa_command* message);

  lcm::LCM lcm_;
  JointVector held_rad_, velocity_radps_;
  Clock::time_point next_, started_, commanded_{};
  int64_t statuses_sent_ = 0;
  bool off_ = false;
};

}  // namespace sidestep::test
