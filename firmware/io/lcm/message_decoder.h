#pragma once

#include <memory>

#include "firmware/control/types/messages.h"
#include "firmware/io/lcm/dialect.h"
#include "firmware/io/lcm/message_bytes.h"
#include "firmware/model/arm.h"
#include "firmware/model/attachments.h"

namespace sidestep {

/// The largest message that can be decoded: a full set of obstacles.
constexpr size_t kLargestMessageBytes = kHeaderBytes + kCountBytes + kMaxObstacles * kObstacleBytes;

constexpr int kMaxNamedJoints = 256;  ///< in one named_joints_t

/// Whether these are the bytes of a joint_target_t.
bool is_joint_target(Packet packet);

/// Bytes of inbound messages to values. A message is decoded only if its fingerprint is right and its size is exactly
/// what its count implies. The numbers are not checked (input_gate.h does). Does not throw; does not allocate after the
/// largest message of each kind.
class MessageDecoder {
 public:
  /// The arm outlives this.
  MessageDecoder(const Dialect& dialect, const Arm& arm);
  ~MessageDecoder();

  /// Each fills the value and returns null; or returns what is wrong with the bytes, as static text, and leaves the
  /// value undefined.
  const char* decode(Packet packet, ArmState& arm);
  const char* decode(Packet packet, Target& target);
  /// A joint_target_t: fills the posture and leaves the other fields neutral.
  const char* decode_joint_target(Packet packet, Target& target);
  const char* decode(Packet packet, Control& control);
  const char* decode(Packet packet, ObstacleSet& obstacles, int64_t& utime);
  const char* decode(Packet packet, Attachments& attachments);
  /// Fills the positions of the named joints. Joints that the arm does not know are skipped: a sender may report all
  /// joints of a robot. A message that names none of the arm's is wrong.
  const char* decode(Packet packet, OtherJoints& joints);

 private:
  struct Scratch;
  std::unique_ptr<Scratch> scratch_;
};

}  // namespace sidestep
