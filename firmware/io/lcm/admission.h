#pragma once

#include <memory>

#include "firmware/control/message_order.h"
#include "firmware/io/lcm/dialect.h"

namespace sidestep {

/// The gate for bytes from outside. A message becomes a value only if its size is exactly what its count implies, its
/// fingerprint is right, every number is plausible and it is newer than the last; anything else is rejected whole,
/// counted and named. Obstacles that jump count in their old place, too. Never throws; does not allocate once each kind
/// of message has been seen at its largest.
class Admission {
 public:
  /// arm_is_clock: in lockstep time is the utime of the arm states, whatever now_s says about them.
  Admission(int joints, const Settings& settings, bool arm_is_clock = false, Dialect dialect = Dialect::kSidestep);
  ~Admission();

  /// Each returns whether `value` was filled; when not, its content is arbitrary. now_s: local time of receipt.
  bool admit(const void* bytes, size_t size, double now_s, ArmState& value);
  bool admit(const void* bytes, size_t size, double now_s, Target& value);
  bool admit(const void* bytes, size_t size, double now_s, ObstacleSet& value);

  int64_t rejected() const { return rejected_; }
  const char* last_reason() const { return reason_; }  ///< static text; "" when nothing was rejected

 private:
  struct Scratch;
  bool reject(const char* reason);

  int joints_;
  Timeouts timeouts_;
  bool arm_is_clock_;
  Order arm_order_, target_order_, obstacles_order_;
  int64_t rejected_ = 0;
  const char* reason_ = "";
  std::unique_ptr<Scratch> scratch_;
};

}  // namespace sidestep
