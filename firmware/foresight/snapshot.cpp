#include "firmware/foresight/snapshot.h"

#include <algorithm>

#include "firmware/control/extrapolation.h"
#include "firmware/model/nearest_points.h"

namespace sidestep {
namespace {

/// The least distance of an obstacle's enclosing ball to the base origin within the horizon, m.
double least_distance_to_base_m(const Obstacle& obstacle, double horizon_s) {
  const Vector3 centre = obstacle.capsule.centre();
  const Vector3 on_path =
      nearest_on_segment(centre, centre + obstacle.velocity_mps * horizon_s, Vector3::Zero().eval());
  return on_path.norm() - obstacle.capsule.extent_m();
}

/// Selects the obstacles with the least distance to the base.
class NearestSelection {
 public:
  NearestSelection(NearbyObstacles& nearby, double horizon_s) : nearby_(nearby), horizon_s_(horizon_s) {
    nearby_.count = 0;
  }

  void consider(const Obstacle& obstacle) {
    const double distance_m = least_distance_to_base_m(obstacle, horizon_s_);
    if (nearby_.count < kMaxNearbyObstacles) {
      distance_m_[nearby_.count] = distance_m;
      nearby_.obstacles[nearby_.count++] = obstacle;
      return;
    }
    const auto farthest = std::max_element(distance_m_.begin(), distance_m_.end());
    if (distance_m >= *farthest) return;
    *farthest = distance_m;
    nearby_.obstacles[farthest - distance_m_.begin()] = obstacle;
  }

 private:
  NearbyObstacles& nearby_;
  double horizon_s_;
  std::array<double, kMaxNearbyObstacles> distance_m_{};
};

}  // namespace

void take_snapshot(const Model& model, const Inputs& inputs, const State& state, double now_s, Snapshot& snapshot) {
  snapshot.tracking = state.supervision.mode == Mode::kTrack;
  if (!snapshot.tracking) return;
  snapshot.now_s = now_s;
  snapshot.state = state;
  snapshot.arm = state.arm_monitor.accepted.state;
  const LinkPoses poses = forward_kinematics(model.arm, snapshot.arm.position_rad);
  snapshot.target = present_target(model, poses, inputs.target, now_s);

  NearestSelection nearest(snapshot.nearby, model.settings.foresight.horizon_s);
  const ObstacleView view = view_obstacles(model, inputs.obstacles, now_s);
  for (int i = 0; i < view.count(); ++i) nearest.consider(view.extrapolated(i));
}

}  // namespace sidestep
