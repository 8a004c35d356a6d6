#pragma once

#include <cstdlib>

#include "firmware/control/validation.h"

namespace sidestep::fuzz {

inline void require(bool condition) {
  if (!condition) std::abort();
}

inline void require_plausible(const ObstacleSet& set) {
  require(set.count >= 0 && set.count <= kMaxObstacles);
  for (int i = 0; i < set.count; ++i) require(plausible(set.obstacles[static_cast<size_t>(i)]));
}

}  // namespace sidestep::fuzz
