#pragma once

#include <memory>

#include "firmware/io/lcm/packet.h"
#include "firmware/model/obstacle.h"

namespace sidestep {

/// Obstacles to the bytes of an obstacles_t. Allocates only in the constructor.
class ObstacleEncoder {
 public:
  explicit ObstacleEncoder(int max_obstacles);
  ~ObstacleEncoder();

  void begin(int64_t utime);
  void add(const Obstacle& obstacle);
  /// Valid until the next begin(). Empty when more obstacles were added than the constructor allowed for: a part of a
  /// set must not be taken for the whole.
  Packet finish();

 private:
  struct Messages;
  std::unique_ptr<Messages> messages_;
};

}  // namespace sidestep
