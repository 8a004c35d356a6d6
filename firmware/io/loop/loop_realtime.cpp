#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <thread>

#include "firmware/base/realtime.h"
#include "firmware/base/triple_buffer.h"
#include "firmware/io/lcm/admission.h"
#include "firmware/io/lcm/obstacle_merger.h"
#include "firmware/io/loop/cycle_runner.h"
#include "firmware/io/loop/loop.h"

namespace sidestep {
namespace {

constexpr int kLoopPriority = 80;
constexpr int kReceivePriority = 70;  // below the loop: a flood of messages must not delay a cycle
constexpr double kLongestBraking_s = 5.0;

/// The receiving side: checks what comes in and puts the newest valid message of each kind into its mailbox.
class Receiver {
 public:
  Receiver(Wire& wire, const Config& config)
      : wire_(wire),
        admission_(config.model.arm.joints, config.model.settings, false, config.dialect),
        obstacle_merger_(config) {
    wire.on_arm_state([this](const void* bytes, size_t size) { post(bytes, size, monotonic_s(), arm); });
    wire.on_target([this](const void* bytes, size_t size) { post(bytes, size, monotonic_s(), target); });
    wire.on_obstacles([this](const void* bytes, size_t size) { join(0, bytes, size); });
    for (size_t k = 0; k < config.neighbours.listen.size(); ++k)
      wire.on_neighbour(k, [this, k](const void* bytes, size_t size) { join(k + 1, bytes, size); });
    wire.on_foreign_command(false, [this] { foreign_command_s = monotonic_s(); });
  }

  void run(const std::atomic<bool>& end) {
    while (!end) wire_.receive(20);
  }

  TripleBuffer<Received<ArmState>> arm;
  TripleBuffer<Received<Target>> target;
  TripleBuffer<Received<ObstacleSet>> obstacles;
  std::atomic<double> foreign_command_s{-HUGE_VAL};
  std::atomic<int64_t> rejected{0};
  std::atomic<const char*> rejected_reason{""};

 private:
  void join(size_t part, const void* bytes, size_t size) {
    const double now_s = monotonic_s();
    const auto whole = obstacle_merger_.join(part, bytes, size, now_s);
    if (whole) return post(whole->packet.bytes, whole->packet.size, now_s - whole->age_s, obstacles);
    count_rejected(obstacle_merger_);
  }

  template <typename Message>
  void post(const void* bytes, size_t size, double received_s, TripleBuffer<Received<Message>>& buffer) {
    Received<Message>& mail = buffer.draft();
    if (admission_.admit(bytes, size, received_s, mail.message)) {
      const auto* first = static_cast<const uint8_t*>(bytes);
      mail.bytes.assign(first, first + size);
      mail.received_s = received_s;
      mail.count = ++count_;
      buffer.post();
    }
    count_rejected(admission_);
  }

  /// After a message that went no farther than this gate.
  template <typename Gate>
  void count_rejected(const Gate& gate) {
    const int64_t count = admission_.rejected() + obstacle_merger_.rejected();
    if (count > rejected) rejected_reason = gate.last_reason();
    rejected = count;
  }

  Wire& wire_;
  Admission admission_;
  ObstacleMerger obstacle_merger_;
  int64_t count_ = 0;
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
      // Periods that have passed altogether are counted and left out, never caught up.
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
    const LatestInputs post{receiver_.arm.latest(), receiver_.target.latest(), receiver_.obstacles.latest()};
    CycleRunner::CycleTrigger trigger;
    // Received between waking and reading: as if just now.
    trigger.now_s = std::max({now_s, post.arm.received_s, post.target.received_s, post.obstacles.received_s});
    trigger.utime = static_cast<int64_t>(trigger.now_s * 1e6);
    trigger.skipped_cycles = skipped;
    trigger.wake_latency_s = late_s;
    trigger.stop = stop;
    trigger.foreign_command_s = receiver_.foreign_command_s;
    trigger.rejected_messages = receiver_.rejected;
    trigger.rejected_reason = receiver_.rejected_reason;
    runner_.run(post, trigger);
  }

  CycleRunner& runner_;
  Receiver& receiver_;
  double period_s_;
};

/// Asks for a service that a real-time loop needs. Without the permission the loop runs all the same, says so once
/// here and in every status.
void request(bool granted, const char* what, const std::string& why_not, int& limiting) {
  if (granted || limiting & kLimitingNotRealtime) return;
  spdlog::warn("{} is not permitted ({}); the loop may be late", what, why_not);
  limiting |= kLimitingNotRealtime;
}

}  // namespace

LoopSummary run_realtime(const Config& config, const std::string& lcm_url, Requests& requests) {
  std::string why_not;
  int limiting = kLimitingNothing;
  Blackbox blackbox(config, requests.write_blackbox);
  ForesightThread foresight_thread(config.model, false);
  request(lock_memory(why_not), "locking memory", why_not, limiting);
  // LCM starts a thread at the first subscription; it and the receiver inherit the priority of this one.
  request(use_fifo(kLoopPriority, why_not), "FIFO scheduling", why_not, limiting);
  use_fifo(kReceivePriority, why_not);

  Wire wire(lcm_url, config);
  const auto receiver = std::make_unique<Receiver>(wire, config);
  CycleRunner runner(config, wire, blackbox, foresight_thread, false, limiting);
  std::atomic<bool> end{false};
  std::thread receiving([&] { receiver->run(end); });
  use_fifo(kLoopPriority, why_not);
  Loop(runner, *receiver, config.model.settings.period_s()).run(requests.stop);
  end = true;
  receiving.join();
  return {runner.timing(), receiver->rejected};
}

}  // namespace sidestep
