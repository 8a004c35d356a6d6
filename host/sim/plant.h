#pragma once

#include <cstdint>
#include <deque>

#include "host/sim/joints.h"

namespace sidestep::sim {

/// What drives the joints. `ideal` takes a velocity at once; `servo` is a velocity servo that follows with a
/// first-order lag, after a latency, within limits on speed and acceleration.
struct PlantSpec {
  enum class Kind { kIdeal, kServo };
  Kind kind = Kind::kIdeal;
  double lag_s = 0.0;
  double latency_s = 0.0;
  JointVector velocity_limit_radps;
  JointVector acceleration_limit_radps2;
};

/// The arm's joints under velocity commands, starting at rest. Motion between commands is integrated in closed form:
/// the result does not depend on how the time is cut into steps.
class Plant {
 public:
  /// Without a new command for this long the plant stops by itself, as real drives do.
  static constexpr int64_t kWatchdogUs = 50'000;

  Plant(const PlantSpec& spec, const JointVector& start_rad);

  /// No drive takes a command beyond this.
  static constexpr double kAbsurdRadps = 1000.0;

  /// A velocity wanted from now (servo: from now + latency) on. A command of the wrong size, or with a value that is
  /// not finite or absurd, is refused and counted: returns false.
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

  void take_due();
  void glide(double dt_s);

  PlantSpec spec_;
  int64_t latency_us_ = 0;
  int64_t now_us_ = 0;
  int64_t stop_us_;  ///< when the watchdog strikes
  JointVector q_rad_, qd_radps_, wanted_radps_, last_command_radps_;
  std::deque<Pending> pending_;
  int64_t refused_ = 0;
};

}  // namespace sidestep::sim
