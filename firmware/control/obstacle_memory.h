#pragma once

#include <array>
#include <cmath>

#include "firmware/model/obstacle.h"

namespace sidestep {

/// Remembers obstacles at their previous positions for coast_s after a doubtful report:
///
/// - An obstacle jumped: it is reported farther from its last position than it can have moved (the largest of the speed
///   bound and its speeds before and after, times the elapsed time, plus 5 cm of measurement noise). Report and memory
///   may both be wrong, so it also remains at its last position, at rest. The newest 64 jumps are remembered.
/// - An obstacle vanished: it is no longer reported, because the sender lost sight of it or because two senders each
///   report their own obstacles. It coasts on with its last velocity until it is reported again.
///
/// Obstacles are matched by id; the k-th of several obstacles with one id matches the k-th with that id in the set
/// before. The paper's law runs without this memory (coast_s = 0). Large: lives on the heap, like an ObstacleSet.
class ObstacleMemory {
 public:
  /// speed_bound_mps: the speed that an obstacle may have beyond its reported velocity.
  ObstacleMemory(double speed_bound_mps, double coast_s) : speed_bound_mps_(speed_bound_mps), coast_s_(coast_s) {}

  /// Appends the remembered obstacles to a new set, under their ids, as far as the set has room (kMaxObstacles), and
  /// counts them in set.remembered. elapsed_s: since the set before. Work is bounded by n log n; nothing is allocated.
  void add_remembered(ObstacleSet& set, double elapsed_s, double now_s);

  /// A set that was received too late to be the newest, by at most late_s. Its obstacles that the newest set does not
  /// hold are remembered as vanished ones: another sender with a slower clock may report them.
  void add_late_set(const ObstacleSet& set, double late_s, double now_s);

  /// Time of the last set; `otherwise` before the first one.
  double last_set_s(double otherwise) const { return any_set_ ? before_s_ : otherwise; }

 private:
  struct RememberedObstacle {
    Obstacle obstacle;
    double since_s = -HUGE_VAL;  ///< time of its last report
  };
  static constexpr int kMaxJumps = 64;

  /// Obstacles that are no longer reported, sorted by id.
  struct Vanished {
    std::array<RememberedObstacle, kMaxObstacles> obstacles;
    int count = 0;

    void add(const RememberedObstacle& obstacle) {
      if (count < kMaxObstacles) obstacles[count++] = obstacle;
    }
  };

  bool is_valid(const RememberedObstacle& remembered, double now_s) const;
  void sort(const ObstacleSet& set);
  void compare(const ObstacleSet& set, double elapsed_s, double now_s);
  bool could_move(const Obstacle& before, const Obstacle& now, double elapsed_s) const;
  void remember_jump(RememberedObstacle jumped);
  void append(const RememberedObstacle& remembered, double now_s, ObstacleSet& set) const;

  double speed_bound_mps_, coast_s_;
  std::array<Obstacle, kMaxObstacles> before_;  ///< the previous set, sorted by id
  int before_count_ = 0;
  double before_s_ = -HUGE_VAL;
  bool any_set_ = false;
  std::array<int, kMaxObstacles> order_;  ///< indices of the new set, sorted by id
  std::array<RememberedObstacle, kMaxJumps> jumped_;
  int next_jump_ = 0;
  Vanished vanished_[2];  ///< two buffers: the current list and the next one
  int current_ = 0;       ///< index of the current list
};

}  // namespace sidestep
