#pragma once

#include <vector>

#include "firmware/control/message_order.h"

namespace sidestep {

/// A message that was admitted, as it came and as the value it became.
template <typename Message>
struct Received {
  Message message;
  std::vector<uint8_t> bytes;
  double received_s = 0.0;
  int64_t count = 0;  ///< 0: nothing yet

  Latest<Message> latest() const { return {count > 0 ? &message : nullptr, received_s, count}; }
};

/// The newest of each kind, for one cycle.
struct LatestInputs {
  const Received<ArmState>& arm;
  const Received<Target>& target;
  const Received<ObstacleSet>& obstacles;
};

}  // namespace sidestep
