#pragma once

#include "firmware/control/types/messages.h"
#include "firmware/io/lcm/obstacle_encoder.h"
#include "firmware/model/arm.h"

namespace sidestep {

/// The moving arm as other arms avoid it: an obstacles_t with one capsule per link shape, in the world frame, numbered
/// from 0. What the base link is fixed to is skipped, since the other arm may stand on it as well.
class LinkEncoder {
 public:
  /// The arm outlives this.
  LinkEncoder(const Arm& arm, const Eigen::Isometry3d& world_from_base)
      : arm_(arm), world_from_base_(world_from_base), encoder_(kMaxShapes) {}

  /// Does not allocate. The packet is valid until the next call.
  Packet encode(const ArmState& arm, const OtherFrames& others, int64_t utime);

 private:
  const Arm& arm_;
  Eigen::Isometry3d world_from_base_;
  ObstacleEncoder encoder_;
};

}  // namespace sidestep
