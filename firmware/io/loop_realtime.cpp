#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <thread>

#include "firmware/io/admission.h"
#include "firmware/io/loop.h"
#include "firmware/io/mailbox.h"
#include "firmware/io/realtime.h"
#include "firmware/io/wire.h"

namespace sidestep {
namespace {

constexpr int kLoopPriority = 80;
constexpr int kReceivePriority = 70;  // below the loop: a flood of messages must not delay a cycle
constexpr double kLongestBraking_s = 5.0;

template <typename Message>
struct Mail {
  Message message;
  double received_s = 0.0;
  int64_t count = 0;  ///< 0: nothing yet
};

template <typename Message>
Latest<Message> read(Mailbox<Mail<Message>>& mailbox) {
  const Mail<Message>& mail = mailbox.latest();
  return {mail.count > 0 ? &mail.message : nullptr, mail.received_s, mail.count};
}

/// The receiving side: checks what comes in and puts the newest valid message of each kind into its mailbox.
class Receiver {
 public:
  Receiver(Wire& wire, int joints, const Ages& ages) : wire_(wire), admission_(joints, ages, false) {
    wire.on_arm_state([this](const void* bytes, size_t size) { post(bytes, size, arm); });
    wire.on_target([this](const void* bytes, size_t size) { post(bytes, size, target); });
    wire.on_obstacles([this](const void* bytes, size_t size) { post(bytes, size, obstacles); });
  }

  void run(const std::atomic<bool>& end) {
    while (!end) wire_.receive(20);
  }

  Mailbox<Mail<ArmState>> arm;
  Mailbox<Mail<Target>> target;
  Mailbox<Mail<ObstacleSet>> obstacles;
  std::atomic<int64_t> rejected{0};
  std::atomic<const char*> rejected_reason{""};

 private:
  template <typename Message>
  void post(const void* bytes, size_t size, Mailbox<Mail<Message>>& mailbox) {
    Mail<Message>& mail = mailbox.draft();
    const double now_s = monotonic_s();
    if (admission_.admit(bytes, size, now_s, mail.message)) {
      mail.received_s = now_s;
      mail.count = ++count_;
      mailbox.post();
    }
    rejected_reason = admission_.last_reason();
    rejected = admission_.rejected();
  }

  Wire& wire_;
  Admission admission_;
  int64_t count_ = 0;
};

/// The loop itself, on the thread that calls run().
class Loop {
 public:
  Loop(const Model& model, Wire& wire, Receiver& receiver, int limiting)
      : model_(model), wire_(wire), receiver_(receiver), limiting_(limiting) {}

  LoopSummary run(const std::atomic<bool>& stop) {
    const double period_s = model_.settings.period_s();
    double wake_s = monotonic_s() + period_s;
    double stop_s = 0.0;
    while (true) {
      sleep_until(wake_s);
      const double late_s = monotonic_s() - wake_s;
      if (late_s < 0.0) continue;  // a signal woke it
      // Periods that have passed altogether are counted and left out, never caught up.
      const int skipped = static_cast<int>(std::floor(late_s / period_s));
      cycle(wake_s + late_s, late_s, skipped, stop);
      wake_s += (skipped + 1) * period_s;

      if (!stop) continue;
      if (stop_s == 0.0) stop_s = wake_s;
      if (!state_.commanding || state_.velocity_radps.isZero(0.0) || wake_s - stop_s > kLongestBraking_s) break;
    }
    summary_.rejected_messages = receiver_.rejected;
    summary_.cpu_mean_s /= static_cast<double>(std::max<int64_t>(1, summary_.cycles));
    return summary_;
  }

 private:
  void cycle(double now_s, double late_s, int skipped, bool stop) {
    const double cpu_s = thread_cpu_s();
    Inputs inputs;
    inputs.arm = read(receiver_.arm);
    inputs.target = read(receiver_.target);
    inputs.obstacles = read(receiver_.obstacles);
    // Received between waking and reading: as if just now.
    inputs.skipped_cycles = skipped;
    inputs.stop = stop;
    now_s = std::max({now_s, inputs.arm.received_s, inputs.target.received_s, inputs.obstacles.received_s});
    Result result = step(model_, state_, inputs, now_s);
    state_ = result.next;
    result.report.limiting |= limiting_;

    CycleRecord record;
    record.utime = static_cast<int64_t>(now_s * 1e6);
    record.seq = ++summary_.cycles;
    record.wake_latency_s = late_s;
    record.skipped_cycles = summary_.skipped_cycles += skipped;
    record.rejected_messages = receiver_.rejected;
    record.rejected_reason = receiver_.rejected_reason;
    if (result.commanding) wire_.publish(result.command, record.utime, record.seq);
    record.cycle_time_s = thread_cpu_s() - cpu_s;
    wire_.publish(result.report, record);

    summary_.cpu_mean_s += record.cycle_time_s;
    summary_.cpu_worst_s = std::max(summary_.cpu_worst_s, record.cycle_time_s);
    summary_.wake_latency_worst_s = std::max(summary_.wake_latency_worst_s, late_s);
  }

  const Model& model_;
  Wire& wire_;
  Receiver& receiver_;
  int limiting_;
  State state_;
  LoopSummary summary_;
};

/// Asks for a service that a real-time loop needs. Without the permission the loop runs all the same, says so once
/// here and in every status.
void request(bool granted, const char* what, const std::string& why_not, int& limiting) {
  if (granted || limiting & kLimitingNotRealtime) return;
  spdlog::warn("{} is not permitted ({}); the loop may be late", what, why_not);
  limiting |= kLimitingNotRealtime;
}

}  // namespace

LoopSummary run_realtime(const Config& config, const std::string& lcm_url, const std::atomic<bool>& stop) {
  std::string why_not;
  int limiting = kLimitingNothing;
  request(lock_memory(why_not), "locking memory", why_not, limiting);
  // LCM starts a thread at the first subscription; it and the receiver inherit the priority of this one.
  request(use_fifo(kReceivePriority, why_not), "FIFO scheduling", why_not, limiting);

  Wire wire(lcm_url, config.channels, config.model.arm);
  const auto receiver = std::make_unique<Receiver>(wire, config.model.arm.joints, config.model.settings.ages);
  std::atomic<bool> end{false};
  std::thread receiving([&] { receiver->run(end); });
  use_fifo(kLoopPriority, why_not);
  const LoopSummary summary = Loop(config.model, wire, *receiver, limiting).run(stop);
  end = true;
  receiving.join();
  return summary;
}

}  // namespace sidestep
