#include "host/campaign/decoys.h"

#include <algorithm>

#include "host/campaign/random.h"

namespace sidestep::campaign {
namespace {

constexpr double kLeast_m = 0.25, kMost_m = 0.5;             // distance from the arm at its start
constexpr double kSmallest_m = 0.005, kLargest_m = 0.08;     // radius
constexpr double kRoom_m = kMost_m + kLargest_m + kLeast_m;  // around the arm, in which centres are drawn

}  // namespace

void add_decoys(Scene& scene, int count) {
  Random random("decoys", scene.seed);
  const ArmPose pose = scene.arm->pose(scene.start_rad);
  Vector3 low = pose.corners.front(), high = low;
  for (const Vector3& corner : pose.corners) low = low.cwiseMin(corner), high = high.cwiseMax(corner);
  low.array() -= kRoom_m;
  high.array() += kRoom_m;
  while (count > 0) {
    sim::Obstacle decoy;
    decoy.solid.shape = sim::Shape::kSphere;
    decoy.solid.size_m = {random.uniform(kSmallest_m, kLargest_m), 0.0, 0.0};
    decoy.motion.position_m = random.in_box(low, high);
    const double clearance_m = scene.arm->clearance(pose, decoy.motion.position_m, decoy.solid.size_m.x());
    if (clearance_m < kLeast_m || clearance_m > kMost_m) continue;
    scene.furniture.push_back(decoy);
    --count;
  }
  scene.shuffles_obstacles = true;
}

}  // namespace sidestep::campaign
