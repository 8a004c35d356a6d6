#include "firmware/foresight/snapshot.h"

#include <algorithm>
#include <cmath>

#include "firmware/base/bounded_list.h"
#include "firmware/control/extrapolation.h"
#include "firmware/model/nearest_points.h"

namespace sidestep {
namespace {

/// The arm's moving links, and a ball around them.
struct MovingLinks {
  BoundedList<Capsule, kMaxShapes> capsules;
  Vector3 centre = Vector3::Zero();
  double radius_m = 0.0;

  MovingLinks(const Arm& arm, const LinkPoses& poses) {
    for (int s = 0; s < shape_count(arm, poses); ++s)
      if (shape_at(arm, poses, s).body > 0) capsules.add(transformed(poses, shape_at(arm, poses, s)));
    for (const Capsule& capsule : capsules) centre += capsule.centre() / capsules.size();
    for (const Capsule& capsule : capsules)
      radius_m = std::max(radius_m, (capsule.centre() - centre).norm() + capsule.extent_m());
  }
};

/// Selects the obstacles whose enclosing balls come nearest to the links within the horizon.
class NearestSelection {
 public:
  NearestSelection(const MovingLinks& links, double horizon_s, NearbyObstacles& nearby)
      : links_(links), horizon_s_(horizon_s), nearby_(nearby) {
    nearby_.count = 0;
  }

  void consider(const Obstacle& obstacle) {
    const double enough_m = nearby_.count < kMaxNearbyObstacles ? HUGE_VAL : distance_m_[farthest_];
    const double distance_m = least_distance_m(obstacle, enough_m);
    if (distance_m >= enough_m) return;
    const int place = nearby_.count < kMaxNearbyObstacles ? nearby_.count++ : farthest_;
    distance_m_[place] = distance_m;
    nearby_.obstacles[place] = obstacle;
    if (nearby_.count == kMaxNearbyObstacles)
      farthest_ = static_cast<int>(std::max_element(distance_m_.begin(), distance_m_.end()) - distance_m_.begin());
  }

 private:
  /// Of the ball around an obstacle to the links within the horizon, m; not exact where it is at least enough_m.
  double least_distance_m(const Obstacle& obstacle, double enough_m) const {
    const Vector3 centre = obstacle.capsule.centre(), end = centre + obstacle.velocity_mps * horizon_s_;
    const Capsule path{centre, end, obstacle.capsule.extent_m()};
    const double to_ball_m =
        (nearest_on_segment(centre, end, links_.centre) - links_.centre).norm() - links_.radius_m - path.radius_m;
    if (to_ball_m >= enough_m) return to_ball_m;
    double least_m = HUGE_VAL;
    for (const Capsule& link : links_.capsules) {
      const NearestPoints points = nearest_on_axes(link, path);
      least_m = std::min(least_m, (points.a - points.b).norm() - link.radius_m - path.radius_m);
    }
    return least_m;
  }

  const MovingLinks& links_;
  double horizon_s_;
  NearbyObstacles& nearby_;
  std::array<double, kMaxNearbyObstacles> distance_m_{};
  int farthest_ = 0;
};

}  // namespace

OtherFrames place_others(const Arm& arm, const OtherJoints& joints, const Attachments& attachments) {
  OtherFrames frames = place_other_joints(arm, joints);
  if (!attachments.is_empty()) frames.attachments = &attachments;
  return frames;
}

void take_snapshot(const Model& model, const Inputs& inputs, const State& state, double now_s, Snapshot& snapshot) {
  snapshot.moves = moves(state.supervision.mode);
  snapshot.tracking = state.supervision.mode == Mode::kTrack;
  if (!snapshot.moves) return;
  snapshot.now_s = now_s;
  snapshot.state = state;
  snapshot.arm = state.arm_monitor.accepted.state;
  snapshot.others = inputs.other_joints.message ? *inputs.other_joints.message : model.arm.other_positions;
  snapshot.others.velocity.fill(0.0);
  if (inputs.attachments.message)
    snapshot.attachments = *inputs.attachments.message;
  else
    snapshot.attachments = {};
  const OtherFrames others = place_others(model.arm, snapshot.others, snapshot.attachments);
  const LinkPoses poses = forward_kinematics(model.arm, snapshot.arm.position_rad, others);
  if (snapshot.tracking)
    snapshot.target = present_target(model, tool_jacobian(poses, target_rows(inputs.target)), inputs.target, now_s);

  const ObstacleView view = view_obstacles(model, inputs.obstacles, now_s);
  if (view.count() <= kMaxNearbyObstacles) {
    snapshot.nearby.count = view.count();
    for (int i = 0; i < view.count(); ++i) snapshot.nearby.obstacles[i] = view.extrapolated(i);
    return;
  }
  const MovingLinks links(model.arm, poses);
  NearestSelection nearest(links, model.settings.foresight.horizon_s, snapshot.nearby);
  for (int i = 0; i < view.count(); ++i) nearest.consider(view.extrapolated(i));
}

}  // namespace sidestep
