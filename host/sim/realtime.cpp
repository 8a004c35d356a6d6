#include <algorithm>

#include "host/sim/clock.h"
#include "host/sim/run.h"

namespace sidestep::sim {
namespace {

// The controller runs on its own clock, so the two loops drift against each other and each takes what the other sent
// last. The delay of the closed loop is the age of that. Two things keep it low without synchronizing anything.
// ARM_STATE goes out every 2 ms, like a real arm's status: the controller finds one at most 2 ms old, where one per
// control period would be up to 10 ms old and, worse, drift through all ages in between. And a command acts the moment
// it arrives, not at the next tick: the loop sleeps in poll(), and the plant is exact for any length of time.
// TARGET and OBSTACLES carry velocities; once per control period is enough for them.
constexpr int64_t kTickUs = 2'000;

class RealTime {
 public:
  RealTime(Run& run, Bus& bus)
      : run_(run),
        bus_(bus),
        sensing_(run.scenario().sensing),
        ticks_(std::max<int64_t>(1, run.scenario().period_us / kTickUs)),
        origin_us_(monotonic_us()),
        plant_us_(origin_us_),
        heard_us_(origin_us_) {}

  // Takes one message, or waits for the next tick, or does it when it is due.
  void step() {
    const int64_t due_us = due_at(tick_);
    const int64_t now_us = monotonic_us();
    if (now_us < due_us) {
      if (const auto answer = bus_.next(due_us - now_us)) take(*answer, std::min(monotonic_us(), due_us));
    } else {
      on_tick(due_us, now_us < due_at(tick_ + 1));
      ++tick_;
    }
  }

  int64_t silent_us() const { return monotonic_us() - heard_us_; }

 private:
  int64_t due_at(int64_t tick) const { return origin_us_ + tick * run_.scenario().period_us / ticks_; }

  void advance_to(int64_t time_us) {
    run_.plant.advance(time_us - plant_us_);
    plant_us_ = time_us;
  }

  void take(const Answer& answer, int64_t at_us) {
    advance_to(std::max(at_us, plant_us_));
    heard_us_ = at_us;
    std::visit([this](const auto& message) { run_.take(message); }, answer);
    const auto* status = std::get_if<Status>(&answer);
    if (started_ || !status || status->mode != Mode::kTrack) return;
    started_ = true;
    origin_us_ = plant_us_;
    tick_ = 0;
  }

  // After a late wake-up all overdue ticks are recorded, but only the last of them is published.
  void on_tick(int64_t due_us, bool publish) {
    advance_to(due_us);
    const bool starts_period = tick_ % ticks_ == 0;
    if (publish && starts_period) publish_world(due_us);
    if (publish) publish_arm(due_us);
    if (!starts_period) return;
    if (started_) run_.record(run_.plant.q_rad(), run_.plant.qd_radps());
    if (!started_) run_.show_waiting();
  }

  void publish_world(int64_t due_us) {
    const World world = run_.world();
    if (const auto target = sensing_.target(world.target)) bus_.publish(*target, due_us);
    if (const auto obstacles = sensing_.obstacles(world.obstacles)) bus_.publish(*obstacles, due_us);
  }

  void publish_arm(int64_t due_us) {
    if (const auto q_rad = sensing_.joints(run_.plant.q_rad())) bus_.publish(*q_rad, run_.plant.qd_radps(), due_us);
  }

  Run& run_;
  Bus& bus_;
  Sensing sensing_;
  const int64_t ticks_;  // per control period
  int64_t origin_us_;    // of tick 0; moves to t = 0 once
  int64_t tick_ = 0;
  int64_t plant_us_;      // how far the plant has been moved
  int64_t heard_us_;      // last message of the controller
  bool started_ = false;  // the controller has tracked
};

}  // namespace

End run_realtime(Run& run, Bus& bus, double patience_s, const std::atomic<bool>& interrupted) {
  const int64_t give_up_us = monotonic_us() + static_cast<int64_t>(patience_s * 1e6);
  RealTime loop(run, bus);
  while (!interrupted) {
    loop.step();
    if (run.complete()) return End::kDone;
    if (!run.tracked() && monotonic_us() > give_up_us) return End::kNeverTracked;
    if (run.tracked() && loop.silent_us() > kLostAfterUs) return End::kLost;
  }
  return End::kInterrupted;
}

}  // namespace sidestep::sim
