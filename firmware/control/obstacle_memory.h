#pragma once

#include <array>
#include <cmath>

#include "firmware/base/bounded_list.h"
#include "firmware/control/obstacle_order.h"

namespace sidestep {

/// An obstacle whose report is doubtful is kept for coast_s after its last good report. There are three cases:
///
/// - A jump. An obstacle may move by max(speed bound, its speed before, its speed now) * elapsed time + 5 cm, which
///   covers measurement noise. If it is reported farther away, the report may be wrong. Then a copy stays at the last
///   position, at rest, besides the reported one.
/// - A shrink. If a radius or half an edge of an obstacle has become smaller by more than 1 cm, or its shape is another
///   one, the sender may see only a part of it. Then a copy of the old size moves on with its last velocity, besides
///   the reported one. The newest kMaxObstacles jumps and shrinks are kept.
/// - A vanished obstacle. If an id is no longer reported, the sender may have lost sight of it, or two senders on one
///   channel alternate with their own obstacles. The obstacle moves on with its last velocity, until it is reported
///   again or coast_s is over.
///
/// Obstacles are matched by id; obstacles with the same id are matched in the order of the message. The paper's law
/// runs without this memory (coast_s = 0). Large: lives on the heap, like an ObstacleSet.
class ObstacleMemory {
 public:
  /// speed_bound_mps: the speed that any obstacle may have, whatever velocity is reported.
  ObstacleMemory(double speed_bound_mps, double coast_s) : speed_bound_mps_(speed_bound_mps), coast_s_(coast_s) {}

  /// Appends the remembered obstacles to a new set, under their ids, as far as the set has room (kMaxObstacles), and
  /// counts them in set.remembered. elapsed_s: since the set before. Work is bounded by n log n; nothing is allocated.
  void add_remembered(ObstacleSet& set, double elapsed_s, double now_s);

  /// For a set whose utime is older than that of the newest set: it was delayed, or another sender whose clock is
  /// behind sent it. An obstacle that only the late set holds is kept as a vanished one, as if last reported now. An
  /// obstacle that both sets hold is tested for a jump or a shrink from the late set to the newest one, as if late_s
  /// had elapsed. If the test is positive, a copy of the late report is kept as above: at rest after a jump, moving on
  /// after a shrink. The input gate passes timeouts.obstacles_s as late_s.
  void add_late_set(const ObstacleSet& set, double late_s, double now_s);

  /// Whether the last set has an obstacle with this id.
  bool holds(int32_t id) const;

  /// Time of the last set; `otherwise` before the first one.
  double last_set_s(double otherwise) const { return any_set_ ? before_s_ : otherwise; }

 private:
  struct RememberedObstacle {
    Obstacle obstacle;
    double since_s = -HUGE_VAL;  ///< time of its last report
  };

  using Remembered = BoundedList<RememberedObstacle, kMaxObstacles>;

  static void keep(const RememberedObstacle& obstacle, Remembered& list) {
    if (!list.is_full()) list.add(obstacle);
  }

  bool is_valid(const RememberedObstacle& remembered, double now_s) const;
  void compare(const ObstacleSet& set, double elapsed_s, double now_s);
  bool could_move(const Obstacle& before, const Obstacle& now, double elapsed_s) const;
  void remember(const RememberedObstacle& changed);
  void remember_change(RememberedObstacle before, const Obstacle& now, double elapsed_s);
  void append(const RememberedObstacle& remembered, double now_s, ObstacleSet& set) const;

  double speed_bound_mps_, coast_s_;
  std::array<Obstacle, kMaxObstacles> before_;  ///< the previous set, sorted by id
  int before_count_ = 0;
  double before_s_ = -HUGE_VAL;
  bool any_set_ = false;
  ObstacleOrder order_;     ///< of the new set
  Remembered changed_;      ///< jumped or shrunk
  int next_change_ = 0;     ///< the place to overwrite once the list is full
  Remembered vanished_[2];  ///< no longer reported, sorted by id. Two buffers: the current list and the next one
  int current_ = 0;         ///< index of the current list
};

}  // namespace sidestep
