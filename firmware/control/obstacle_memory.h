#pragma once

#include <array>
#include <cmath>

#include "firmware/model/obstacle.h"

namespace sidestep {

/// Remembers where obstacles were. One that is suddenly elsewhere, farther away than it could move, may be there; but
/// it may also be a mistake of whoever reports it, its velocity included, so that its old place counts as well for a
/// short while. So does one that is no longer reported, moving on as it did, until it comes back: somebody may have
/// lost sight of it, or two who report each know but their own.
///
/// Large, like an ObstacleSet. Obstacles are the same when their id is; the k-th of several with one id is the same as
/// the k-th in the set before.
class ObstacleMemory {
 public:
  /// speed_bound_mps: how fast an obstacle may be beyond what is reported. memory_s: how long an old place counts.
  ObstacleMemory(double speed_bound_mps, double memory_s) : speed_bound_mps_(speed_bound_mps), memory_s_(memory_s) {}

  /// Adds the old places that count now to a new set, under their ids, as far as the set has room. elapsed_s: from the
  /// set before to this one, for what could move. The work is bounded by n log n; nothing is allocated.
  void complete(ObstacleSet& set, double elapsed_s, double now_s);

  /// A set that is too late to be the newest, by at most late_s as far as is known. What the newest does not know of
  /// counts from the next one on, for the same while; it may be of another who reports, whose clock is behind.
  void add_late_set(const ObstacleSet& set, double late_s, double now_s);

 private:
  struct RememberedObstacle {
    Obstacle obstacle;
    double since_s = -HUGE_VAL;
  };
  static constexpr int kMostJumps = 64;  ///< the newest

  /// What is no longer reported, by id.
  struct Gone {
    std::array<RememberedObstacle, kMaxObstacles> places;
    int count = 0;

    void add(const RememberedObstacle& place) {
      if (count < kMaxObstacles) places[count++] = place;
    }
  };

  bool counts(const RememberedObstacle& place, double now_s) const;
  void sort(const ObstacleSet& set);
  void compare(const ObstacleSet& set, double elapsed_s, double now_s);
  bool could_move(const Obstacle& before, const Obstacle& now, double elapsed_s) const;
  void remember_jump(RememberedObstacle place);
  void add(const RememberedObstacle& place, double now_s, ObstacleSet& set) const;

  double speed_bound_mps_, memory_s_;
  std::array<Obstacle, kMaxObstacles> before_;  ///< the set before, by id
  int before_count_ = 0;
  double before_s_ = -HUGE_VAL;
  std::array<int, kMaxObstacles> order_;  ///< of the new set, by id
  std::array<RememberedObstacle, kMostJumps> jumped_;
  int next_jump_ = 0;
  Gone gone_[2];  ///< now, and when the set before came
  int now_ = 0;   ///< which of them
};

}  // namespace sidestep
