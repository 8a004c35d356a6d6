#include "host/campaign/boxes/boxes_maker.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "host/campaign/furniture/assembly.h"
#include "host/campaign/segment.h"

namespace sidestep::campaign {
namespace {

constexpr double kDuration_s = 30.0;
constexpr double kWay_m = 0.5;  // of the tool from start to goal, at least
constexpr double kHole_m = 0.25, kSlab_m = 0.1;
constexpr double kLeastLine_m = 0.1, kStep_m = 0.001;     // length of a box's line; step in which its ends are found
constexpr double kFreeClearance_m = 0.04, kFree_s = 2.0;  // of the goal
constexpr double kLook_s = 0.05;                          // between two looks at the goal
constexpr double kParallel = 1e-9;                        // of the axes of a planar arm, length of a cross product
constexpr int kMostDraws = 2'000;                         // of all boxes

/// Where the centres of the boxes may be.
struct Workspace {
  Vector3 foot_m, shoulder_m;  ///< ends of the base column
  double radius_m;

  bool contains(const Vector3& centre_m) const {
    return centre_m.norm() <= radius_m && centre_m.z() >= 0.5 * kBoxEdge_m &&
           distance_to_segment(foot_m, shoulder_m, centre_m) >= kBaseRegion_m;
  }

  /// From a point within to the wall in this direction.
  double to_wall_m(const Vector3& from_m, const Vector3& direction) const {
    double way_m = 0.0;
    while (contains(from_m + (way_m + kStep_m) * direction)) way_m += kStep_m;
    return way_m;
  }
};

Workspace workspace_of(const ArmPose& pose) {
  Workspace workspace{pose.corners[0], pose.corners[1], kBoxEdge_m};
  for (size_t i = 0; i + 1 < pose.corners.size(); ++i)
    workspace.radius_m += (pose.corners[i + 1] - pose.corners[i]).norm();
  return workspace;
}

std::vector<sim::Obstacle> ground(double size_m) {
  Assembly slabs(Vector3::Zero(), 0.0);
  slabs.add_box({-size_m, kHole_m, -kSlab_m}, {size_m, size_m, 0.0});
  slabs.add_box({-size_m, -size_m, -kSlab_m}, {size_m, -kHole_m, 0.0});
  slabs.add_box({kHole_m, -kHole_m, -kSlab_m}, {size_m, kHole_m, 0.0});
  slabs.add_box({-size_m, -kHole_m, -kSlab_m}, {-kHole_m, kHole_m, 0.0});
  return slabs.solids();
}

/// The direction of all axes of a planar arm.
std::optional<Vector3> normal_of_plane(const ArmPose& pose) {
  const Vector3& first = pose.axes.front();
  const bool parallel = std::all_of(pose.axes.begin(), pose.axes.end(),
                                    [&](const Vector3& axis) { return axis.cross(first).norm() < kParallel; });
  if (!parallel) return std::nullopt;
  return first;
}

/// A box's line through the workspace; none if the draw does not fit.
std::optional<BoxPath> draw_path(Random& random, const Scene& scene, const ArmPose& pose, const Workspace& workspace) {
  const double radius_m = workspace.radius_m;
  Vector3 start_m = random.in_box({-radius_m, -radius_m, 0.0}, {radius_m, radius_m, radius_m});
  Vector3 direction = random.direction();
  const double speed_mps = random.uniform(0.0, scene.family->speed_mps);
  if (const auto normal = normal_of_plane(pose)) {
    start_m += normal->dot(pose.tool() - start_m) * *normal;
    direction = (direction - normal->dot(direction) * *normal).normalized();
  }
  if (!workspace.contains(start_m)) return std::nullopt;
  const double ahead_m = workspace.to_wall_m(start_m, direction), behind_m = workspace.to_wall_m(start_m, -direction);
  if (ahead_m + behind_m < kLeastLine_m) return std::nullopt;
  return BoxPath(start_m, speed_mps * direction, ahead_m, behind_m);
}

bool draw_boxes(Random& random, Scene& scene) {
  const ArmPose pose = scene.arm->pose(scene.start_rad);
  const Workspace workspace = workspace_of(pose);
  const auto wanted = static_cast<size_t>(scene.family->most_obstacles);
  scene.boxes.clear();
  for (int draw = 0; draw < kMostDraws && scene.boxes.size() < wanted; ++draw) {
    const auto path = draw_path(random, scene, pose, workspace);
    if (!path) continue;
    scene.boxes.push_back(*path);
    if (scene.arm->solid_clearance(pose, {boxes_at(scene, 0.0).back()}, kBoxStartClearance_m) < kBoxStartClearance_m)
      scene.boxes.pop_back();
  }
  return scene.boxes.size() == wanted;
}

/// Whether the boxes keep clear of the arm in its goal posture for kFree_s at a stretch.
bool goal_becomes_free(const Scene& scene) {
  const ArmPose pose = scene.arm->pose(scene.goal_rad);
  double free_s = 0.0;
  for (double t_s = 0.0; t_s < scene.duration_s() && free_s < kFree_s; t_s += kLook_s) {
    const bool free = scene.arm->solid_clearance(pose, boxes_at(scene, t_s), kFreeClearance_m) >= kFreeClearance_m;
    free_s = free ? free_s + kLook_s : 0.0;
  }
  return free_s >= kFree_s;
}

/// Whether the arm keeps clear of the ground and of itself.
bool keeps_clear(const Scene& scene, const ArmPose& pose) {
  return scene.arm->solid_clearance(pose, scene.furniture, kGroundClearance_m) >= kGroundClearance_m &&
         scene.arm->self_clearance(pose, kLinksClearance_m) >= kLinksClearance_m;
}

}  // namespace

bool make_boxes(Random& random, Scene& scene, const Joints& start_rad, const Joints& goal_rad) {
  scene.start_rad = start_rad;
  scene.goal_rad = goal_rad;
  scene.periods = static_cast<int>(kDuration_s / kPeriod_s);
  const ArmPose start = scene.arm->pose(start_rad), goal = scene.arm->pose(goal_rad);
  scene.furniture = ground(workspace_of(start).radius_m + kBoxEdge_m);
  if ((goal.tool() - start.tool()).norm() < kWay_m) return false;
  if (!keeps_clear(scene, start) || !keeps_clear(scene, goal)) return false;
  return draw_boxes(random, scene) && goal_becomes_free(scene);
}

}  // namespace sidestep::campaign
