#pragma once

#include <array>
#include <vector>

#include "firmware/io/lcm/message_bytes.h"
#include "firmware/model/types.h"

namespace sidestep {

/// Parts that the codecs of all dialects share.

/// Decodes a message of `numbers_each` doubles per joint; null, or what is wrong with the bytes.
template <typename Message>
const char* decode_arm_state(Packet packet, int joints, size_t numbers_each, Message& message) {
  if (!has_fingerprint<Message>(packet)) return "arm state of another type";
  if (count_of(packet) != joints) return "arm state with a wrong number of joints";
  return decode_counted(packet, 8 * numbers_each, message) ? nullptr : "arm state of wrong size";
}

inline JointVector joints_of(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

inline void copy_joints(const JointVector& from, std::vector<double>& to) {
  to.assign(from.data(), from.data() + from.size());
}

/// A buffer for the bytes of one small message.
class PacketBuffer {
 public:
  template <typename Message>
  Packet encode(const Message& message) {
    const int size = message.encode(bytes_.data(), 0, static_cast<int>(bytes_.size()));
    return {bytes_.data(), size > 0 ? static_cast<size_t>(size) : 0};
  }

 private:
  std::array<uint8_t, 2048> bytes_;  // a status with the longest names and message takes 1160
};

}  // namespace sidestep
