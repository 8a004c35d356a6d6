#pragma once

#include "firmware/model/arm.h"

namespace sidestep {

/// The joints outside the chain as their messages have told so far. A message may name any of them.
class OtherJointMemory {
 public:
  /// timeout_s: positions farther apart in time give no velocity.
  OtherJointMemory(const Arm& arm, double timeout_s);

  /// Replaces the positions of joints that the message does not name by their last ones, at first those of
  /// Arm::other_positions. The velocity of a joint is the difference quotient of its last two positions by the sender's
  /// clock, within its velocity limit. It is 0 if they are farther apart in time than timeout_s, or the last one is
  /// older than that: another sender may go on naming other joints. Positions are not smoothed: a link is where it is
  /// reported, from now on.
  void complete(OtherJoints& joints);

 private:
  double timeout_s_;
  size_t joints_;
  std::array<double, kMaxOtherJoints> fastest_{};  ///< rad/s, or m/s; infinite without a limit
  OtherJoints last_;
  std::array<int64_t, kMaxOtherJoints>
      named_utime_{};  ///< of the last message that named the joint; meaningful where last_.named
};

}  // namespace sidestep
