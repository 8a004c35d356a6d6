#pragma once

#include <vector>

#include "firmware/control/types/inputs.h"
#include "firmware/io/lcm/packet.h"

namespace sidestep {

/// An accepted message: its value, its bytes as they came, and when it was received.
template <typename Message>
struct Received {
  Message message;
  std::vector<uint8_t> bytes;  ///< empty for an obstacle set that was merged from several messages
  double received_s = 0.0;
  int64_t count = 0;  ///< accepted messages of the channel up to this one; 0: none yet

  /// Does not allocate once the largest message has been stored.
  void store(Packet packet, double at_s) {
    bytes.assign(packet.bytes, packet.bytes + packet.size);
    received_s = at_s;
  }
  Latest<Message> latest() const { return {count > 0 ? &message : nullptr, received_s, count}; }
};

/// The newest accepted message of each kind, for one cycle.
struct LatestInputs {
  const Received<ArmState>& arm;
  const Received<Target>& target;
  const Received<ObstacleSet>& obstacles;
  const Received<OtherJoints>& other_joints;
  const Received<Control>& control;
  const Received<Attachments>& attachments;
};

}  // namespace sidestep
