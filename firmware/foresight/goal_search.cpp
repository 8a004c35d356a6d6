#include "firmware/foresight/goal_search.h"

#include "firmware/foresight/rollout.h"

namespace sidestep {
namespace {

constexpr double kSamePlace_m = 0.005;
constexpr double kSameOrientation_rad = 0.03;
constexpr int kSearchesUntilOutOfReach = 30;  // of at least 6 starts each

}  // namespace

void GoalSearch::set_goal(const Target& target) {
  const bool same =
      is_same_posture(target, target_, joint_scale_) && target.tracks_orientation == target_.tracks_orientation &&
      (target.position_m - target_.position_m).norm() <= kSamePlace_m &&
      (!target.tracks_orientation || target.orientation.angularDistance(target_.orientation) <= kSameOrientation_rad);
  if (same) return;
  clear();
  target_ = target;
}

GoalFinding GoalSearch::finding() const {
  if (blocked_) return GoalFinding::kPostureBlocked;
  return failures_ >= kSearchesUntilOutOfReach ? GoalFinding::kOutOfReach : GoalFinding::kNone;
}

}  // namespace sidestep
