#include "host/campaign/dodge_maker.h"

#include <cmath>

#include "firmware/model/capsule.h"
#include "firmware/model/nearest_points.h"

namespace sidestep::campaign {
namespace {

constexpr double kRunUp_m = 0.9, kAfterCrossing_m = 2.0;  // length of a line before and after its crossing point
constexpr double kColumnDistance_m = 0.25;
constexpr double kStartClearance_m = 0.05;
constexpr double kReturn_s = 2.0;
constexpr int kMostDraws = 10'000;

/// Draws start and direction of a sphere's line. Returns false if the line is too close to the base column or to the
/// arm at its start.
bool draw_line(Random& random, const JudgeArm& arm, const ArmPose& pose, Vector3& start_m, Vector3& direction) {
  const auto link = static_cast<size_t>(random.integer(1, static_cast<int>(pose.corners.size()) - 2));
  const double share = random.uniform(0.0, 1.0);
  const Vector3 crossing_m = pose.corners[link] + share * (pose.corners[link + 1] - pose.corners[link]);
  direction = random.direction();
  start_m = crossing_m - kRunUp_m * direction;
  const NearestPoints nearest = nearest_on_axes({pose.corners[0], pose.corners[1], 0.0},
                                                {start_m, crossing_m + kAfterCrossing_m * direction, 0.0});
  return (nearest.a - nearest.b).norm() >= kColumnDistance_m &&
         arm.clearance(pose, start_m, kSphereRadius_m) >= kStartClearance_m;
}

}  // namespace

bool make_dodge(Random& random, Scene& scene, const Joints& start_rad) {
  const Family& family = *scene.family;
  scene.start_rad = scene.goal_rad = start_rad;
  scene.crossing_s = kRunUp_m / family.speed_mps;
  scene.periods = static_cast<int>(std::ceil((pass_ends_s(scene) + kReturn_s) / kPeriod_s));
  const ArmPose pose = scene.arm->pose(start_rad);
  Vector3 start_m, direction;
  const auto wanted = static_cast<size_t>(family.most_obstacles);
  scene.spheres.clear();
  for (int draw = 0; draw < kMostDraws && scene.spheres.size() < wanted; ++draw)
    if (draw_line(random, *scene.arm, pose, start_m, direction))
      scene.spheres.emplace_back(start_m, family.speed_mps * direction);
  return scene.spheres.size() == wanted;
}

}  // namespace sidestep::campaign
