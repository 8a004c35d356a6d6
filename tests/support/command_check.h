#pragma once

#include <cstdint>
#include <string>

#include "firmware/model/arm.h"

namespace sidestep::test {

/// Watches a stream of joint commands and names the first thing that an arm could not follow: a value that is not
/// finite, a jump, a velocity, acceleration or position beyond the limits, of what is said or of how the positions
/// move, or a position that is not where the velocity leads.
class CommandCheck {
 public:
  CommandCheck(const JointLimits& limits, double period_s) : limits_(limits), period_s_(period_s) {}

  /// A stream begins: its first command must go on from this measured arm.
  void begin(const JointVector& position_rad, const JointVector& velocity_radps);

  void feed(const JointVector& position_rad, const JointVector& velocity_radps);

  /// Of an arm that is pushed the commanded position follows it beside the velocity. Only that is granted.
  void grant_catching_up() { catching_up_ = true; }

  /// The stream ends, which it may do only at rest.
  void end();

  /// The first complaint, with the number of the command; empty while all is well.
  const std::string& complaint() const { return complaint_; }
  int64_t fed() const { return fed_; }

 private:
  void complain(const char* what, int joint, double value, double bound);

  JointLimits limits_;
  double period_s_;
  JointVector position_rad_, velocity_radps_, rate_radps_;  ///< of the last command; the rate is of the positions
  bool catching_up_ = false;
  int64_t fed_ = 0;
  std::string complaint_;
};

}  // namespace sidestep::test
