#pragma once

#include <cstdint>
#include <deque>

#include "host/sim/joints.h"

namespace sidestep::sim {

/// Model of the joint drives. `ideal` reaches a commanded velocity at once. `servo` follows it after a latency, with a
/// first-order lag and within limits on speed and acceleration.
struct PlantSpec {
  enum class Kind { kIdeal, kServo };
  Kind kind = Kind::kIdeal;
  double lag_s = 0.0;
  double latency_s = 0.0;
  JointVector velocity_limit_radps;
  JointVector acceleration_limit_radps2;
};

/// The arm's joints under velocity commands, at rest at the start. Motion between commands is integrated in closed
/// form: the result does not depend on the length of the time steps.
class Plant {
 public:
  /// Without a new command for this time the plant stops, as real drives do.
  static constexpr int64_t kWatchdog_us = 50'000;

  Plant(const PlantSpec& spec, const JointVector& start_rad);

  /// Commands beyond this speed are refused.
  static constexpr double kImplausible_radps = 1000.0;

  /// Commands a velocity, valid from now on (servo: from now + latency on). A command of the wrong size or with a value
  /// that is not finite or beyond kImplausible_radps is refused and counted: returns false.
  bool command(const Eigen::Ref<const Eigen::VectorXd>& qd_radps);

  void advance(int64_t dt_us);

  const JointVector& q_rad() const { return q_rad_; }
  const JointVector& qd_radps() const { return qd_radps_; }
  const JointVector& last_command_radps() const { return last_command_radps_; }
  int64_t refused() const { return refused_; }

 private:
  struct Pending {
    int64_t due_us;
    JointVector qd_radps;
  };

  void apply_due();
  void integrate(double dt_s);

  PlantSpec spec_;
  int64_t latency_us_ = 0;
  int64_t now_us_ = 0;
  int64_t stop_us_;  ///< when the watchdog stops the plant
  JointVector q_rad_, qd_radps_, demand_radps_, last_command_radps_;
  std::deque<Pending> pending_;
  int64_t refused_ = 0;
};

}  // namespace sidestep::sim
