#pragma once

#include <algorithm>
#include <array>
#include <numeric>

#include "firmware/model/obstacle.h"

namespace sidestep {

/// Indices of the obstacles of a set.
using ObstacleOrder = std::array<int, kMaxObstacles>;

/// Sets the first `count` indices to those of all obstacles of the set, sorted by id; obstacles with the same id stay
/// in the order of the message. Nothing is allocated.
inline void sort_by_id(const ObstacleSet& set, ObstacleOrder& order) {
  std::iota(order.begin(), order.begin() + set.count, 0);
  std::sort(order.begin(), order.begin() + set.count, [&](int a, int b) {
    const int32_t id_a = set.obstacles[a].id, id_b = set.obstacles[b].id;
    return id_a != id_b ? id_a < id_b : a < b;
  });
}

}  // namespace sidestep
