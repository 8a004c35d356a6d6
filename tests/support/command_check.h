#pragma once

#include <cstdint>
#include <string>

#include "firmware/model/arm.h"

namespace sidestep::test {

/// Checks a stream of joint commands and reports the first violation that an arm could not follow: a value that is not
/// finite, a jump, a velocity, acceleration or position beyond the limits (velocity and acceleration both as commanded
/// and as differences of the positions), or a position that does not follow from the velocity.
class CommandCheck {
 public:
  CommandCheck(const JointLimits& limits, double period_s) : limits_(limits), period_s_(period_s) {}

  /// Begins a stream whose first command must continue this measured motion.
  void begin(const JointVector& position_rad, const JointVector& velocity_radps);

  void feed(const JointVector& position_rad, const JointVector& velocity_radps);

  /// From now on positions need not follow from the velocities. If an external force displaces the arm, the controller
  /// corrects the commanded positions towards the measured ones. All other checks stay.
  void allow_position_correction() { position_correction_allowed_ = true; }

  /// Ends the stream. The last velocity must be zero.
  void end();

  /// The first violation with the number of the command; empty if there is none.
  const std::string& violation() const { return violation_; }
  int64_t fed() const { return fed_; }

 private:
  void report(const char* what, int joint, double value, double bound);

  JointLimits limits_;
  double period_s_;
  JointVector position_rad_, velocity_radps_, rate_radps_;  ///< of the last command; rate_radps_: position difference
  bool position_correction_allowed_ = false;
  int64_t fed_ = 0;
  std::string violation_;
};

}  // namespace sidestep::test
