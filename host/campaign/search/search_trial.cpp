#include "host/campaign/search/search_trial.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "host/sim/plant.h"

namespace sidestep::campaign {
namespace {

constexpr int kMostCyclesUntilReady = 500;
constexpr int kChecksPerPeriod = 5;

Obstacle obstacle_at(const MovingCapsule& capsule, double t_s) {
  Obstacle obstacle;
  obstacle.shape = capsule.half_axis_m.isZero(0.0) ? Shape::kSphere : Shape::kCapsule;
  obstacle.capsule = capsule.at(t_s);
  obstacle.velocity_mps = capsule.velocity_mps;
  return obstacle;
}

/// The closed loop of scene, plant and controller, with the controller's clock.
class Loop {
 public:
  Loop(const SearchScene& scene, TrialController& controller)
      : scene_(scene),
        controller_(controller),
        plant_({}, scene.start_rad),
        target_{lwa3_arm().pose(scene.start_rad).tool(), Vector3::Zero()} {}

  Joints q_rad() const { return plant_.q_rad(); }

  /// One cycle at the scene's time t_s, and the plant's motion until the next.
  ControllerOutput advance(double t_s) {
    const Joints q_rad = plant_.q_rad(), qd_radps = plant_.qd_radps();
    measurement_.received_us = now_us_;
    ++measurement_.count;
    measurement_.obstacles.clear();
    for (const MovingCapsule& obstacle : scene_.obstacles) measurement_.obstacles.push_back(obstacle_at(obstacle, t_s));
    const PointMotion* target = scene_.family == SearchFamily::kTrack ? &target_ : nullptr;
    ControllerOutput output = controller_.cycle({now_us_, q_rad, qd_radps, target, std::nullopt, measurement_});
    plant_.command(output.velocity_radps);
    plant_.advance(kPeriod_us);
    now_us_ += kPeriod_us;
    return output;
  }

 private:
  const SearchScene& scene_;
  TrialController& controller_;
  sim::Plant plant_;
  PointMotion target_;
  ObstacleMeasurement measurement_;
  int64_t now_us_ = 1'000'000;
};

/// Between two periods the ideal plant moves at constant joint velocity.
void measure(const SearchScene& scene, const Joints& from_rad, const Joints& to_rad, double from_s,
             ClosestApproach& closest) {
  for (int i = 1; i <= kChecksPerPeriod; ++i) {
    const double share = static_cast<double>(i) / kChecksPerPeriod, t_s = from_s + share * kPeriod_s;
    const ArmPose pose = lwa3_arm().pose(from_rad + share * (to_rad - from_rad));
    const double least_m = clearance_m(scene, pose, t_s, closest.clearance_m);
    if (least_m < closest.clearance_m) closest = {least_m, t_s};
    const double self_m = lwa3_arm().self_clearance(pose, 0.0);
    if (self_m < std::min(0.0, closest.clearance_m)) closest = {self_m, t_s};
  }
}

}  // namespace

ClosestApproach run_search_trial(const SearchScene& scene, TrialController& controller) {
  Loop loop(scene, controller);
  ClosestApproach closest;
  Joints before_rad = loop.q_rad();
  ControllerOutput output = loop.advance(0.0);
  for (int cycle = 1; !output.ready; ++cycle) {
    if (cycle == kMostCyclesUntilReady)
      throw std::runtime_error(fmt::format("the controller did not become ready: {}", output.message));
    before_rad = loop.q_rad();
    output = loop.advance(0.0);
  }
  for (int k = 0; k < scene.periods(); ++k) {
    if (k > 0) {
      before_rad = loop.q_rad();
      loop.advance(k * kPeriod_s);
    }
    measure(scene, before_rad, loop.q_rad(), k * kPeriod_s, closest);
  }
  return closest;
}

}  // namespace sidestep::campaign
