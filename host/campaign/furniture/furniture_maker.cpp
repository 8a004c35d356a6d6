#include "host/campaign/furniture/furniture_maker.h"

#include <cmath>

#include "host/campaign/furniture/mover.h"
#include "host/campaign/furniture/path_planner.h"
#include "host/campaign/furniture/pieces.h"
#include "host/campaign/furniture/witness_plan.h"
#include "host/campaign/plain_tracking.h"

namespace sidestep::campaign {
namespace {

constexpr double kRest_s = 5.0, kLongest_s = 15.0;     // time after the witness's motion; longest scene
constexpr int kMostGoals = 20'000, kMostStarts = 100;  // draws of a posture
constexpr int kMostPieces = 10;                        // draws of furniture around a goal

Joints draw_joints(Random& random, const Limits& range, double share) {
  Joints q_rad(range.lower_rad.size());
  for (int i = 0; i < q_rad.size(); ++i) {
    const double middle_rad = 0.5 * (range.lower_rad[i] + range.upper_rad[i]);
    q_rad[i] = middle_rad + share * (random.uniform(range.lower_rad[i], range.upper_rad[i]) - middle_rad);
  }
  return q_rad;
}

bool lies_in(const GoalRegion& region, const ArmPose& pose) {
  const Vector3 &tool_m = pose.tool(), pointing = (tool_m - pose.wrist()).normalized();
  const double away_m = tool_m.head<2>().norm();
  if (away_m < region.nearest_m || away_m > region.farthest_m) return false;
  if (tool_m.z() < region.lowest_m || tool_m.z() > region.highest_m) return false;
  return pointing.z() <= region.most_upward &&
         pointing.head<2>().dot(tool_m.head<2>()) >= region.least_outward * away_m;
}

/// Draws a goal posture and furniture around its tool.
bool draw_goal(Random& random, Scene& scene) {
  const JudgeArm& arm = *scene.arm;
  const GoalRegion region = goal_region(scene.family->furniture);
  for (int draw = 0; draw < kMostGoals; ++draw) {
    scene.goal_rad = draw_joints(random, arm.range(), 0.9);
    const ArmPose pose = arm.pose(scene.goal_rad);
    if (!lies_in(region, pose) || !arm.keeps_clear_of_itself(pose)) continue;
    for (int piece = 0; piece < kMostPieces; ++piece) {
      scene.furniture = draw_furniture(random, scene.family->furniture, pose.tool());
      if (keeps_clear(scene, scene.goal_rad, kFurnitureClearance_m)) return true;
    }
  }
  return false;
}

bool draw_start(Random& random, Scene& scene) {
  for (int draw = 0; draw < kMostStarts; ++draw) {
    scene.start_rad = draw_joints(random, scene.arm->range(), 0.7);
    if (scene.arm->pose(scene.start_rad).tool().z() > 0.15 &&
        keeps_clear(scene, scene.start_rad, kFurnitureClearance_m))
      return true;
  }
  return false;
}

/// Whether the straight joint path from start to goal touches the furniture.
bool straight_path_is_blocked(const Scene& scene) {
  const Joints way_rad = scene.goal_rad - scene.start_rad;
  const int steps = static_cast<int>(way_rad.norm() / kPlannedStep_rad) + 1;
  for (int k = 0; k <= steps; ++k) {
    const ArmPose pose = scene.arm->pose(scene.start_rad + static_cast<double>(k) / steps * way_rad);
    if (scene.arm->solid_clearance(pose, scene.furniture, 0.0) < 0.0) return true;
  }
  return false;
}

}  // namespace

bool make_furniture(Random& random, Scene& scene) {
  scene.spheres.clear();
  scene.witness_path = {};
  scene.goal_has_orientation = scene.arm->goal_has_orientation();
  scene.periods = static_cast<int>(kLongest_s / kPeriod_s);
  if (!draw_goal(random, scene) || !draw_start(random, scene)) return false;
  if (!straight_path_is_blocked(scene) || !plain_tracking_hits(scene)) return false;
  if (!plan_witness(random, scene, kFurnitureClearance_m)) return false;
  scene.periods = static_cast<int>(std::ceil((scene.witness_s + kRest_s) / kPeriod_s));
  if (scene.duration_s() > kLongest_s) return false;
  return !scene.family->mover || draw_mover(random, scene);
}

}  // namespace sidestep::campaign
