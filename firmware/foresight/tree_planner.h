#pragma once

#include <limits>

#include "firmware/base/split_mix64.h"
#include "firmware/foresight/free_space.h"
#include "firmware/foresight/path_timing.h"

namespace sidestep {

/// Plans paths among obstacles at rest: out of boxes, into shelves, under tables. Two random trees (RRT-Connect;
/// Kuffner and LaValle 2000), one from the arm and one from the target's posture or from up to 8 at the target, grow
/// toward each other in joint space. The path where they meet is shortened, and timed with blended corners
/// (path_timing.h).
///
/// The work is cut into slices, one per call of plan(): about kChecksPerSlice configurations are examined. What a slice
/// has found is kept for the next one while the target and the obstacles at rest stay where they are. Trees that have
/// not met after 30 slices are given up, for new ones with other goals and twice as much time: the way may be closed to
/// all goals of the first ones. Large: lives on the heap.
class TreePlanner {
 public:
  explicit TreePlanner(const Model& model);

  /// Forgets what it has found, and restarts the random sequence from foresight.seed.
  void reset();

  /// One slice, from a snapshot in TRACK. Returns a guide, with ForesightStatus::kGuided, in the slice that completes
  /// one; it starts with zero velocity, now or after a pause, ends at least 1 s before the horizon, and up to the
  /// horizon obstacles that move or turn, as predicted_obstacle(), stay foresight.clearance_m away (slow ones less,
  /// required_clearance.h). Else without knots, for example while the target moves.
  Guide plan(const Snapshot& from) { return run_slice(from, std::numeric_limits<double>::infinity()); }

  /// The same for an arm that is under way already: the guide leads straight to the last point of the path to which the
  /// way is free. The tool is no faster than fastest_mps.
  Guide plan_under_way(const Snapshot& from, double fastest_mps) { return run_slice(from, fastest_mps); }

  /// Whether the posture of the target, in a snapshot in TRACK, is too near to an obstacle at rest or to the arm
  /// itself.
  bool is_blocked(const Snapshot& from);

  /// Whether it has found a configuration with the tool at this target.
  bool has_goal(const Snapshot& now) const { return goals_rad_.size() > 0 && is_current(now); }

 private:
  struct Node {
    JointVector q_rad;
    int parent;  ///< -1: a root
  };
  static constexpr int kMaxNodes = 4000;
  static constexpr int kMaxGoals = 8;
  using Tree = BoundedList<Node, kMaxNodes>;
  enum class Extension { kTrapped, kAdvanced, kReached };

  bool is_current(const Snapshot& now) const;
  double rest_clearance_m() const;
  void begin(const Snapshot& from);
  void begin_anew(const Snapshot& from);
  void find_goals();
  void grow();
  void clear_trees();
  JointVector random_configuration();
  int nearest(const Tree& tree, const JointVector& q_rad) const;
  Extension extend(Tree& tree, const JointVector& toward_rad);
  Extension connect(Tree& tree, const JointVector& toward_rad);
  bool join();
  void shorten();
  void try_shortcut();
  double length_rad(const JointVector& from_rad, const JointVector& to_rad) const;
  Guide run_slice(const Snapshot& from, double fastest_mps);
  JointPath path_from(const JointVector& q_rad, bool under_way) const;
  Guide finish(const Snapshot& from, double fastest_mps);
  bool is_clear_of_movers(const Snapshot& from, const Guide& guide) const;

  const Model& model_;
  SplitMix64 random_;
  FreeSpace free_;
  bool valid_ = false;  ///< the following belong to a target and obstacles
  Target target_;
  JointVector start_rad_;
  BoundedList<JointVector, kMaxGoals> goals_rad_;
  Tree trees_[2];        ///< from the arm and from the goals
  int checks_left_ = 0;  ///< of this slice
  int slices_left_ = 0;  ///< until the trees are given up
  int patience_ = 0;     ///< slices that the present trees were given
  JointPath path_;       ///< from the arm to a goal, once the trees have met
  int pruned_ = 0;       ///< up to this point of the path no corner can be left out
  int shortcuts_left_ = 0;
};

}  // namespace sidestep
