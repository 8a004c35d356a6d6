#include <algorithm>
#include <vector>

#include "host/sim/clock.h"
#include "host/sim/play.h"

namespace sidestep::sim {
namespace {

// The controller runs on its own clock, so the two loops drift against each other and each takes what the other sent
// last. The delay of the closed loop is the age of that. Two things keep it low without synchronizing anything.
// ARM_STATE goes out every 2 ms, like a real arm's status: the controller finds one at most 2 ms old, where one per
// control period would be up to 10 ms old and, worse, drift through all ages in between. And a command acts the moment
// it arrives, not at the next tick: the loop sleeps in poll(), and the plant is exact for any length of time.
// TARGET and OBSTACLES carry velocities; once per control period is enough for them.
constexpr int64_t kTickUs = 2'000;

// One arm on the wall's clock.
class Side {
 public:
  Side(size_t arm, Run& run, Bus& bus, int64_t now_us)
      : arm_(arm), run_(run), bus_(bus), sensing_(run.scenario().sensing), plant_us_(now_us), heard_us_(now_us) {}

  void advance_to(int64_t time_us) {
    run_.plant.advance(time_us - plant_us_);
    plant_us_ = time_us;
  }

  // Returns when that is for the plant.
  int64_t take(const Answer& answer, int64_t at_us) {
    advance_to(std::max(at_us, plant_us_));
    heard_us_ = at_us;
    run_.take(answer);
    return plant_us_;
  }

  void publish_world(int64_t due_us) {
    const World world = run_.world();
    if (const auto target = sensing_.target(world.target)) bus_.publish(arm_, *target, due_us);
    if (const auto obstacles = sensing_.obstacles(world.obstacles)) bus_.publish(arm_, *obstacles, due_us);
  }

  void publish_arm(int64_t due_us) {
    if (const auto q_rad = sensing_.joints(run_.plant.q_rad()))
      bus_.publish(arm_, *q_rad, run_.plant.qd_radps(), due_us);
  }

  void measure() { run_.measure(); }
  int64_t heard_us() const { return heard_us_; }

 private:
  size_t arm_;
  Run& run_;
  Bus& bus_;
  Sensing sensing_;
  int64_t plant_us_;  // how far the plant has been moved
  int64_t heard_us_;  // last message of the controller
};

class RealTime {
 public:
  RealTime(Play& play, Bus& bus)
      : play_(play),
        bus_(bus),
        ticks_(std::max<int64_t>(1, play.scenario().period_us / kTickUs)),
        origin_us_(monotonic_us()) {
    for (size_t arm = 0; arm < play.runs.size(); ++arm) sides_.emplace_back(arm, play.runs[arm], bus, origin_us_);
  }

  // Takes one message, or waits for the next tick, or does it when it is due.
  void step() {
    const int64_t due_us = due_at(tick_);
    const int64_t now_us = monotonic_us();
    if (now_us < due_us) {
      if (const auto heard = bus_.next(due_us - now_us)) take(*heard, std::min(monotonic_us(), due_us));
    } else {
      on_tick(due_us, now_us < due_at(tick_ + 1));
      ++tick_;
    }
  }

  // Of the controller that has been silent longest.
  int64_t silent_us() const {
    const auto earlier = [](const Side& a, const Side& b) { return a.heard_us() < b.heard_us(); };
    return monotonic_us() - std::min_element(sides_.begin(), sides_.end(), earlier)->heard_us();
  }

 private:
  int64_t due_at(int64_t tick) const { return origin_us_ + tick * play_.scenario().period_us / ticks_; }

  void take(const Heard& heard, int64_t at_us) {
    const int64_t taken_us = sides_[heard.arm].take(heard.answer, at_us);
    if (started_ || !play_.tracking()) return;
    started_ = true;
    origin_us_ = taken_us;
    tick_ = 0;
  }

  // After a late wake-up all overdue ticks are recorded, but only the last of them is published.
  void on_tick(int64_t due_us, bool publish) {
    const bool starts_period = tick_ % ticks_ == 0;
    for (Side& side : sides_) {
      side.advance_to(due_us);
      if (publish && starts_period) side.publish_world(due_us);
      if (publish) side.publish_arm(due_us);
      if (starts_period) side.measure();
    }
    if (!starts_period) return;
    if (started_) play_.record();
    if (!started_) play_.show_waiting();
  }

  Play& play_;
  Bus& bus_;
  std::vector<Side> sides_;
  const int64_t ticks_;  // per control period
  int64_t origin_us_;    // of tick 0; moves to t = 0 once
  int64_t tick_ = 0;
  bool started_ = false;  // all controllers have tracked
};

}  // namespace

End run_realtime(Play& play, Bus& bus, double patience_s, const std::atomic<bool>& interrupted) {
  const int64_t give_up_us = monotonic_us() + static_cast<int64_t>(patience_s * 1e6);
  RealTime loop(play, bus);
  while (!interrupted) {
    loop.step();
    if (play.complete()) return End::kDone;
    if (!play.tracked() && monotonic_us() > give_up_us) return End::kNeverTracked;
    if (play.tracked() && loop.silent_us() > kLostAfterUs) return End::kLost;
  }
  return End::kInterrupted;
}

}  // namespace sidestep::sim
