#include <algorithm>
#include <vector>

#include "host/sim/clock.h"
#include "host/sim/simulation.h"

namespace sidestep::sim {
namespace {

// Simulator and controller run on their own clocks, which drift against each other, and each uses the latest message of
// the other. The age of that message is the delay of the closed loop. Two measures keep it small without synchronizing
// the clocks:
// - ARM_STATE is sent every 2 ms, like the status of a real arm, so the controller finds a state at most 2 ms old. With
//   one ARM_STATE per control period the age would drift between 0 and 10 ms.
// - A command takes effect on arrival, not at the next tick: the loop sleeps in poll(), and the plant integrates over
//   any time exactly.
// TARGET and OBSTACLES carry velocities; once per control period is enough for them.
constexpr int64_t kTick_us = 2'000;

/// One arm on the monotonic clock.
class RealTimeArm {
 public:
  RealTimeArm(size_t arm, Run& run, SimWire& wire, int64_t now_us)
      : arm_(arm),
        run_(run),
        wire_(wire),
        sensing_(run.scenario().sensing),
        plant_us_(now_us),
        last_message_us_(now_us) {}

  void advance_to(int64_t time_us) {
    run_.plant.advance(time_us - plant_us_);
    plant_us_ = time_us;
  }

  /// Returns the time of the plant at which the message took effect.
  int64_t receive(const ControllerMessage& message, int64_t at_us) {
    advance_to(std::max(at_us, plant_us_));
    last_message_us_ = at_us;
    run_.receive(message);
    return plant_us_;
  }

  void publish_world(int64_t due_us) {
    const World& world = run_.world();
    if (world.target)
      if (const auto target = sensing_.target(*world.target)) wire_.publish(arm_, *target, due_us);
    if (const auto obstacles = sensing_.obstacles(world.obstacles)) wire_.publish(arm_, *obstacles, due_us);
    if (world.grip) wire_.publish(arm_, *world.grip, due_us);
  }

  void publish_arm(int64_t due_us) {
    if (const auto q_rad = sensing_.joints(run_.plant.q_rad()))
      wire_.publish(arm_, *q_rad, run_.plant.qd_radps(), due_us);
  }

  void measure() { run_.measure(); }
  int64_t last_message_us() const { return last_message_us_; }

 private:
  size_t arm_;
  Run& run_;
  SimWire& wire_;
  Sensing sensing_;
  int64_t plant_us_;         ///< the plant is integrated up to this time
  int64_t last_message_us_;  ///< receipt time of the controller's last message
};

class RealTimeLoop {
 public:
  RealTimeLoop(Simulation& simulation, SimWire& wire)
      : simulation_(simulation),
        wire_(wire),
        ticks_(std::max<int64_t>(1, simulation.scenario().period_us / kTick_us)),
        origin_us_(monotonic_us()) {
    for (size_t arm = 0; arm < simulation.runs.size(); ++arm)
      arms_.emplace_back(arm, simulation.runs[arm], wire, origin_us_);
  }

  /// Before the next tick is due: waits for one message and handles it. Otherwise: executes the tick.
  void step() {
    const int64_t due_us = due_at(tick_);
    const int64_t now_us = monotonic_us();
    if (now_us < due_us) {
      if (const auto received = wire_.next(due_us - now_us)) receive(*received, std::min(monotonic_us(), due_us));
    } else {
      on_tick(due_us, now_us < due_at(tick_ + 1));
      ++tick_;
    }
  }

  /// Time since the last message of the controller that has been silent longest.
  int64_t silent_us() const {
    const auto earlier = [](const RealTimeArm& a, const RealTimeArm& b) {
      return a.last_message_us() < b.last_message_us();
    };
    return monotonic_us() - std::min_element(arms_.begin(), arms_.end(), earlier)->last_message_us();
  }

 private:
  int64_t due_at(int64_t tick) const { return origin_us_ + tick * simulation_.scenario().period_us / ticks_; }

  void receive(const ReceivedMessage& received, int64_t at_us) {
    const int64_t effective_us = arms_[received.arm].receive(received.message, at_us);
    if (started_ || !simulation_.ready()) return;
    started_ = true;
    origin_us_ = effective_us;
    tick_ = 0;
  }

  // After a late wake-up all overdue ticks are recorded, but only the last of them is published.
  void on_tick(int64_t due_us, bool publish) {
    const bool starts_period = tick_ % ticks_ == 0;
    for (RealTimeArm& arm : arms_) {
      arm.advance_to(due_us);
      if (starts_period) arm.measure();
      if (publish && starts_period) arm.publish_world(due_us);
      if (publish) arm.publish_arm(due_us);
    }
    if (!starts_period) return;
    if (started_) simulation_.record();
    if (!started_) simulation_.show_waiting();
  }

  Simulation& simulation_;
  SimWire& wire_;
  std::vector<RealTimeArm> arms_;
  const int64_t ticks_;   ///< per control period
  int64_t origin_us_;     ///< time of tick 0; set to t = 0 when all controllers track
  int64_t tick_ = 0;      ///< the next one
  bool started_ = false;  ///< t = 0 has passed
};

}  // namespace

Outcome run_realtime(Simulation& simulation, SimWire& wire, double patience_s, const std::atomic<bool>& interrupted) {
  const int64_t deadline_us = monotonic_us() + static_cast<int64_t>(patience_s * 1e6);
  RealTimeLoop loop(simulation, wire);
  while (!interrupted) {
    loop.step();
    if (simulation.complete()) return Outcome::kDone;
    if (!simulation.tracked() && monotonic_us() > deadline_us) return Outcome::kNeverTracked;
    if (simulation.tracked() && loop.silent_us() > kLostAfter_us) return Outcome::kLost;
  }
  return Outcome::kInterrupted;
}

}  // namespace sidestep::sim
