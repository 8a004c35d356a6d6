#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <thread>

#include "firmware/base/log.h"
#include "firmware/base/realtime.h"
#include "firmware/base/triple_buffer.h"
#include "firmware/io/lcm/network_inputs.h"
#include "firmware/io/loop/cycle_runner.h"
#include "firmware/io/loop/loop.h"
#include "firmware/io/loop/service_watchdog.h"

namespace sidestep {
namespace {

constexpr int kLoopPriority = 80;
constexpr int kReceivePriority = 70;  // below the loop: a flood of messages must not delay a cycle
constexpr double kLongestBraking_s = 5.0;

/// The receiving thread: passes the newest accepted message of each kind to the loop through a triple buffer.
class Receiver {
 public:
  Receiver(Wire& wire, const Config& config, Requests& requests)
      : wire_(wire), inputs_(config.model.settings, config.model.arm, *config.dialect, config.neighbours, false) {
    wire.on_arm_state([this](Packet packet) { receive(arm, packet); });
    wire.on_target([this](Packet packet) { receive(target, packet); });
    wire.on_joint_target([this](Packet packet) { receive_joint_target(packet); });
    wire.on_other_joints([this](Packet packet) { receive(other_joints, packet); });
    wire.on_control([this, &requests](Packet packet) { receive_control(packet, requests); });
    wire.on_attachments([this](Packet packet) { receive(attachments, packet); });
    wire.on_obstacles([this](Packet packet) { receive_obstacles(0, packet); });
    for (size_t k = 0; k < config.neighbours.listen.size(); ++k)
      wire.on_neighbour(k, [this, k](Packet packet) { receive_obstacles(k + 1, packet); });
    wire.on_foreign_command(false, [this] { foreign_command_s = wire_.received_s(); });
  }

  void run(const std::atomic<bool>& end) {
    ServiceWatchdog watchdog;
    while (!end) {
      wire_.receive(20);
      watchdog.report(cycles, monotonic_s());
    }
  }

  /// The accepted messages of one kind. count: how many there were.
  template <typename Message>
  struct Channel : TripleBuffer<Received<Message>> {
    int64_t count = 0;
  };

  Channel<ArmState> arm;
  Channel<Target> target;
  Channel<ObstacleSet> obstacles;
  Channel<OtherJoints> other_joints;
  Channel<Control> control;
  Channel<Attachments> attachments;
  std::atomic<int64_t> cycles{0};  ///< counted by the loop
  std::atomic<double> foreign_command_s{-HUGE_VAL};
  std::atomic<int64_t> rejected{0};
  std::atomic<const char*> rejected_reason{""};

 private:
  template <typename Message>
  void receive(Channel<Message>& channel, Packet packet) {
    const bool accepted = inputs_.receive(packet, wire_.received_s(), channel.draft());
    publish(accepted, channel);
  }

  void receive_joint_target(Packet packet) {
    const bool accepted = inputs_.receive_joint_target(packet, wire_.received_s(), target.draft());
    publish(accepted, target);
  }

  void receive_control(Packet packet, Requests& requests) {
    const bool accepted = inputs_.receive(packet, wire_.received_s(), control.draft());
    if (accepted && control.draft().message.command == ControlCommand::kStop) requests.stop = true;
    publish(accepted, control);
  }

  void receive_obstacles(size_t part, Packet packet) {
    const bool accepted = inputs_.receive_obstacles(part, packet, wire_.received_s(), obstacles.draft());
    publish(accepted, obstacles);
  }

  template <typename Message>
  void publish(bool accepted, Channel<Message>& channel) {
    if (accepted) {
      channel.draft().count = ++channel.count;
      channel.publish();
    }
    rejected_reason = inputs_.last_reason();
    rejected = inputs_.rejected();
  }

  Wire& wire_;
  NetworkInputs inputs_;
};

/// The loop itself, on the thread that calls run().
class Loop {
 public:
  Loop(CycleRunner& runner, Receiver& receiver, double period_s)
      : runner_(runner), receiver_(receiver), period_s_(period_s) {}

  void run(const std::atomic<bool>& stop) {
    double wake_s = monotonic_s() + period_s_;
    double stop_s = 0.0;
    while (true) {
      sleep_until(wake_s);
      const double late_s = monotonic_s() - wake_s;
      if (late_s < 0.0) continue;  // a signal woke it
      // Whole periods that have passed are counted as skipped cycles and never caught up.
      const int skipped = static_cast<int>(std::floor(late_s / period_s_));
      cycle(wake_s + late_s, late_s, skipped, stop);
      wake_s += (skipped + 1) * period_s_;

      if (!stop) continue;
      if (stop_s == 0.0) stop_s = wake_s;
      if (runner_.at_rest() || wake_s - stop_s > kLongestBraking_s) break;
    }
  }

 private:
  void cycle(double now_s, double late_s, int skipped, bool stop) {
    const LatestInputs latest{receiver_.arm.latest(),       receiver_.target.latest(),
                              receiver_.obstacles.latest(), receiver_.other_joints.latest(),
                              receiver_.control.latest(),   receiver_.attachments.latest()};
    CycleRunner::CycleTrigger trigger;
    // A message received after waking and before this line counts as received now.
    trigger.now_s =
        std::max({now_s, latest.arm.received_s, latest.target.received_s, latest.obstacles.received_s,
                  latest.other_joints.received_s, latest.control.received_s, latest.attachments.received_s});
    trigger.utime = static_cast<int64_t>(trigger.now_s * 1e6);
    trigger.skipped_cycles = skipped;
    trigger.wake_latency_s = late_s;
    trigger.stop = stop;
    trigger.foreign_command_s = receiver_.foreign_command_s;
    trigger.rejected_messages = receiver_.rejected;
    trigger.rejected_reason = receiver_.rejected_reason;
    runner_.run(latest, trigger);
    receiver_.cycles = runner_.timing().cycles;
  }

  CycleRunner& runner_;
  Receiver& receiver_;
  double period_s_;
};

/// Warns once when a real-time service is not permitted, and marks every status. The loop runs nevertheless.
void warn_unless(bool granted, const char* service, const std::string& why_not, int& degraded) {
  if (granted || degraded & kLimitingNotRealtime) return;
  log_warning(fmt::format("{} is not permitted ({}); the loop may be late", service, why_not));
  degraded |= kLimitingNotRealtime;
}

}  // namespace

LoopSummary run_realtime(const Config& config, const std::string& lcm_url, Requests& requests) {
  std::string why_not;
  int degraded = kLimitingNothing;
  Blackbox blackbox(config, requests.write_blackbox);
  ForesightThread foresight_thread(config.model, false);
  const bool locked = lock_memory(why_not);
  warn_unless(locked, "locking memory", why_not, degraded);
  // The receiving thread inherits the priority of this thread.
  const bool fifo = use_fifo(kLoopPriority, why_not);
  warn_unless(fifo, "FIFO scheduling", why_not, degraded);
  use_fifo(kReceivePriority, why_not);

  Wire wire(lcm_url, config.wire());
  const auto receiver = std::make_unique<Receiver>(wire, config, requests);
  CycleRunner runner(config, wire, blackbox, foresight_thread, false, degraded);
  std::atomic<bool> end{false};
  std::thread receiving([&] { receiver->run(end); });
  use_fifo(kLoopPriority, why_not);
  Loop(runner, *receiver, config.model.settings.period_s()).run(requests.stop);
  end = true;
  receiving.join();
  return {runner.timing(), receiver->rejected, wire.reception()};
}

}  // namespace sidestep
