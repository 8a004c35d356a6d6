#include "host/campaign/trial.h"

#include <fmt/format.h>

#include <stdexcept>

#include "host/campaign/judge.h"
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

/// The scene, the arm in it and the clock of the pilot.
class Loop {
 public:
  Loop(const Scene& scene, Pilot& pilot)
      : scene_(scene), pilot_(pilot), plant_(plant_of(scene), scene.start_rad), sensing_(scene) {}

  const sim::Plant& plant() const { return plant_; }

  Steering ask(double t_s) {
    const Joints q_rad = plant_.q_rad(), qd_radps = plant_.qd_radps();
    const Moving target = target_at(scene_, t_s);
    const std::optional<Turning> turning = turning_at(scene_, t_s);
    return pilot_.cycle({now_us_, q_rad, qd_radps, target, turning, sensing_.look(now_us_, t_s)});
  }

  void move(const Steering& steering) {
    plant_.command(steering.velocity_radps);
    plant_.advance(kPeriod_us);
    now_us_ += kPeriod_us;
  }

 private:
  const Scene& scene_;
  Pilot& pilot_;
  sim::Plant plant_;
  Sensing sensing_;
  int64_t now_us_ = 1'000'000;
};

}  // namespace

Outcome run_trial(const Scene& scene, Pilot& pilot) {
  Loop loop(scene, pilot);
  Steering steering = loop.ask(0.0);
  for (int cycle = 0; !steering.tracking; ++cycle) {
    if (cycle == kMostCyclesToTrack)
      throw std::runtime_error(fmt::format("the controller did not track: {}", steering.message));
    loop.move(steering);
    steering = loop.ask(0.0);
  }
  Judge judge(scene, loop.plant().last_command_radps());
  for (int k = 0; k < scene.periods; ++k) {
    if (k > 0) steering = loop.ask(k * kPeriod_s);
    judge.see(k, loop.plant().q_rad());
    judge.hear(steering.velocity_radps, steering.cpu_s);
    loop.move(steering);
  }
  judge.see(scene.periods, loop.plant().q_rad());
  return judge.verdict();
}

}  // namespace sidestep::campaign
