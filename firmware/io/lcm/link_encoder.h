#pragma once

#include "firmware/control/types/messages.h"
#include "firmware/io/config/config.h"
#include "firmware/io/lcm/obstacle_encoder.h"

namespace sidestep {

/// The arm's own links as neighbours are told of them: an obstacles_t in the world frame, numbered from 0.
class LinkEncoder {
 public:
  /// The configuration outlives this.
  explicit LinkEncoder(const Config& config) : config_(config), encoder_(kMaxShapes) {}

  /// Without allocating. Valid until the next call.
  Packet encode(const ArmState& arm, int64_t utime);

 private:
  const Config& config_;
  ObstacleEncoder encoder_;
};

}  // namespace sidestep
