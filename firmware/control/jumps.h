#pragma once

#include <array>

#include "firmware/model/obstacle.h"

namespace sidestep {

/// Remembers where obstacles were. One that is suddenly elsewhere, farther away than it could move, may be there; but
/// it may also be a mistake of whoever reports it, so that its old place counts as well for a short while.
///
/// Large, like an ObstacleSet. Obstacles are the same when their id is; the k-th of several with one id is the same as
/// the k-th in the set before.
class Jumps {
 public:
  /// speed_bound_mps: how fast an obstacle may be beyond what is reported. memory_s: how long an old place counts.
  Jumps(double speed_bound_mps, double memory_s) : speed_bound_mps_(speed_bound_mps), memory_s_(memory_s) {}

  /// Adds the old places that count now to a new set, at rest and under their ids, as far as the set has room.
  /// elapsed_s: from the set before to this one. The work is bounded by n log n; nothing is allocated.
  void complete(ObstacleSet& set, double elapsed_s, double now_s);

 private:
  struct OldPlace {
    Obstacle obstacle;
    double until_s = 0.0;
  };
  static constexpr int kMostPlaces = 64;  ///< the newest

  void sort(const ObstacleSet& set);
  bool could_move(const Obstacle& before, const Obstacle& now, double elapsed_s) const;
  void remember(const Obstacle& obstacle, double now_s);

  double speed_bound_mps_, memory_s_;
  std::array<Obstacle, kMaxObstacles> before_;  ///< by id
  int before_count_ = 0;
  std::array<int, kMaxObstacles> order_;  ///< of the new set, by id
  std::array<OldPlace, kMostPlaces> places_;
  int next_place_ = 0;
};

}  // namespace sidestep
