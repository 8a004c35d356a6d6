#include "host/campaign/trial.h"

#include <fmt/format.h>

#include <stdexcept>

#include "host/campaign/judge.h"
#include "host/campaign/people/people_judge.h"
#include "host/sim/plant.h"

namespace sidestep::campaign {
namespace {

constexpr int kMostCyclesToTrack = 500;

sim::PlantSpec plant_of(const Scene& scene) {
  sim::PlantSpec spec;
  if (!scene.family->real) return spec;
  spec.kind = sim::PlantSpec::Kind::kServo;
  spec.lag_s = kPlantLag_s;
  spec.velocity_limit_radps = scene.arm->limits(*scene.family).velocity_radps;
  spec.acceleration_limit_radps2 = Joints::Constant(scene.start_rad.size(), kPlantAcceleration_radps2);
  return spec;
}

/// The closed loop of scene, plant, sensing and controller, with the controller's clock.
class Loop {
 public:
  Loop(const Scene& scene, TrialController& controller)
      : scene_(scene), controller_(controller), plant_(plant_of(scene), scene.start_rad), sensing_(scene) {}

  const sim::Plant& plant() const { return plant_; }

  ControllerOutput control(double t_s) {
    const Joints q_rad = plant_.q_rad(), qd_radps = plant_.qd_radps();
    const PointMotion target = target_at(scene_, t_s);
    const std::optional<OrientationTarget> orientation_target = orientation_target_at(scene_, t_s);
    const Joints* posture_rad = scene_.family->posture ? &scene_.goal_rad : nullptr;
    return controller_.cycle(
        {now_us_, q_rad, qd_radps, &target, orientation_target, sensing_.newest_at(now_us_, t_s), posture_rad});
  }

  void apply(const ControllerOutput& output) {
    plant_.command(output.velocity_radps);
    plant_.advance(kPeriod_us);
    now_us_ += kPeriod_us;
  }

 private:
  const Scene& scene_;
  TrialController& controller_;
  sim::Plant plant_;
  Sensing sensing_;
  int64_t now_us_ = 1'000'000;
};

}  // namespace

TrialMetrics run_trial(const Scene& scene, TrialController& controller) {
  Loop loop(scene, controller);
  ControllerOutput output = loop.control(0.0);
  for (int cycle = 0; !output.ready; ++cycle) {
    if (cycle == kMostCyclesToTrack)
      throw std::runtime_error(fmt::format("the controller did not track: {}", output.message));
    loop.apply(output);
    output = loop.control(0.0);
  }
  Judge judge(scene, loop.plant().last_command_radps());
  PeopleJudge people_judge(scene);
  for (int k = 0;; ++k) {
    judge.record_state(k, loop.plant().q_rad());
    people_judge.record_state(loop.plant().q_rad());
    if (k == scene.periods || judge.is_decided()) break;
    if (k > 0) output = loop.control(k * kPeriod_s);
    judge.record_command(output.velocity_radps, output.cpu_s);
    loop.apply(output);
  }
  TrialMetrics metrics = judge.metrics();
  if (scene.family->has_people()) people_judge.complete(metrics, judge.contacts());
  return metrics;
}

}  // namespace sidestep::campaign
