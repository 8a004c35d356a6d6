#pragma once

#include "firmware/foresight/snapshot.h"

namespace sidestep {

/// What the searches of foresight show about the goal itself. A goal is new when it has moved by more than 5 mm or 0.03
/// rad, or a posture by more than 0.005 rad.
class GoalSearch {
 public:
  explicit GoalSearch(const Arm& arm) : joint_scale_(arm.joint_scale) {}

  void clear() { failures_ = 0, blocked_ = false; }
  void forget_goal() { clear(), known_ = false; }

  /// Forgets what was found about another goal. Returns whether this one is new.
  bool set_goal(const Target& target);

  /// A search for configurations with the tool at the target, of several random starts each.
  void searched(bool found) { failures_ = found ? 0 : failures_ + 1; }

  /// Whether the arm is too near to something in the target's posture.
  void examined(bool blocked) { blocked_ = blocked; }

  /// kOutOfReach after 30 searches in vain in a row.
  GoalFinding finding() const;

 private:
  JointVector joint_scale_;
  bool known_ = false;  ///< target_
  Target target_;
  int failures_ = 0;
  bool blocked_ = false;
};

}  // namespace sidestep
