#pragma once

#include <memory>

#include "firmware/io/lcm/encoder.h"
#include "firmware/model/obstacle.h"

namespace sidestep {

/// Obstacles to the bytes of an obstacles_t. Does not allocate.
class ObstacleEncoder {
 public:
  explicit ObstacleEncoder(int most_obstacles);
  ~ObstacleEncoder();

  void begin(int64_t utime);
  void add(const Obstacle& obstacle);
  /// Valid until the next begin(). Empty when there were more than the most: a part must not be taken for the whole.
  Packet finish();

 private:
  struct Messages;
  std::unique_ptr<Messages> messages_;
};

}  // namespace sidestep
