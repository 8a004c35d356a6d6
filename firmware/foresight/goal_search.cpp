#include "firmware/foresight/goal_search.h"

#include "firmware/foresight/rollout.h"

namespace sidestep {
namespace {

constexpr int kSearchesUntilOutOfReach = 30;  // of at least 6 starts each

}  // namespace

bool GoalSearch::set_goal(const Target& target) {
  if (known_ && is_same_goal(target, target_, joint_scale_)) return false;
  clear();
  known_ = true;
  target_ = target;
  return true;
}

GoalFinding GoalSearch::finding() const {
  if (blocked_) return GoalFinding::kPostureBlocked;
  return failures_ >= kSearchesUntilOutOfReach ? GoalFinding::kOutOfReach : GoalFinding::kNone;
}

}  // namespace sidestep
