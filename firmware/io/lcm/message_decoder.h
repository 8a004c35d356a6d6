#pragma once

#include <memory>

#include "firmware/control/types/messages.h"
#include "firmware/io/lcm/dialect.h"

namespace sidestep {

/// Bytes of inbound messages to values. A message is decoded only if its fingerprint is right and its size is exactly
/// what its count implies. The numbers are not checked (input_gate.h does). Does not throw; does not allocate after the
/// largest message of each kind.
class MessageDecoder {
 public:
  MessageDecoder(const Dialect& dialect, int joints);
  ~MessageDecoder();

  /// Each fills the value and returns null; or returns what is wrong with the bytes, as static text, and leaves the
  /// value undefined.
  const char* decode(Packet packet, ArmState& arm);
  const char* decode(Packet packet, Target& target);
  const char* decode(Packet packet, ObstacleSet& obstacles, int64_t& utime);

 private:
  struct Scratch;
  std::unique_ptr<Scratch> scratch_;
};

}  // namespace sidestep
