#include <algorithm>
#include <memory>

#include "firmware/io/admission.h"
#include "firmware/io/loop.h"
#include "firmware/io/realtime.h"
#include "firmware/io/wire.h"

namespace sidestep {
namespace {

// Asked to stop, the loop waits this long for the next arm state before it ends.
constexpr double kFarewell_s = 0.5;

class Lockstep {
 public:
  Lockstep(const Config& config, const std::string& lcm_url, const std::atomic<bool>& stop)
      : model_(config.model),
        wire_(lcm_url, config.channels, config.model.arm),
        admission_(config.model.arm.joints, config.model.settings.ages, true),
        obstacles_(std::make_unique<Pending<ObstacleSet>>()),
        stop_(stop) {
    wire_.on_arm_state([this](const void* bytes, size_t size) { cycle(bytes, size); });
    wire_.on_target([this](const void* bytes, size_t size) { receive(bytes, size, target_); });
    wire_.on_obstacles([this](const void* bytes, size_t size) { receive(bytes, size, *obstacles_); });
  }

  LoopSummary run() {
    double last_cycle_s = monotonic_s();
    while (!(stop_ && (!state_.commanding || state_.velocity_radps.isZero(0.0)))) {
      const int64_t cycles = summary_.cycles;
      wire_.receive(50);
      if (summary_.cycles != cycles || !stop_) last_cycle_s = monotonic_s();
      if (monotonic_s() - last_cycle_s > kFarewell_s) break;
    }
    summary_.rejected_messages = admission_.rejected();
    summary_.cpu_mean_s /= static_cast<double>(std::max<int64_t>(1, summary_.cycles));
    return summary_;
  }

 private:
  /// A message between two cycles: it was received when the next one begins. Two slots, so that a rejected message
  /// does not spoil the one in use.
  template <typename Message>
  struct Pending {
    Message slots[2];
    int current = 0;
    bool arrived = false;
    Latest<Message> latest;

    void take(double now_s) {
      if (!arrived) return;
      latest = {&slots[current], now_s, latest.count + 1};
      arrived = false;
    }
  };

  template <typename Message>
  void receive(const void* bytes, size_t size, Pending<Message>& pending) {
    const int spare = 1 - pending.current;
    if (!admission_.admit(bytes, size, now_s_, pending.slots[spare])) return;
    pending.current = spare;
    pending.arrived = true;
  }

  void cycle(const void* bytes, size_t size) {
    const double cpu_s = thread_cpu_s();
    if (!admission_.admit(bytes, size, now_s_, arm_)) return;
    now_s_ = static_cast<double>(arm_.utime) * 1e-6;
    target_.take(now_s_);
    obstacles_->take(now_s_);
    Inputs inputs;
    inputs.arm = {&arm_, now_s_, ++arm_count_};
    inputs.target = target_.latest;
    inputs.obstacles = obstacles_->latest;
    inputs.stop = stop_;
    const Result result = step(model_, state_, inputs, now_s_);
    state_ = result.next;

    CycleRecord record;
    record.utime = arm_.utime;
    record.seq = ++summary_.cycles;
    record.rejected_messages = admission_.rejected();
    record.rejected_reason = admission_.last_reason();
    wire_.publish(result.command, record.utime, record.seq);
    record.cycle_time_s = thread_cpu_s() - cpu_s;
    wire_.publish(result.report, record);
    summary_.cpu_mean_s += record.cycle_time_s;
    summary_.cpu_worst_s = std::max(summary_.cpu_worst_s, record.cycle_time_s);
  }

  const Model& model_;
  Wire wire_;
  Admission admission_;
  Pending<Target> target_;
  std::unique_ptr<Pending<ObstacleSet>> obstacles_;
  ArmState arm_;
  int64_t arm_count_ = 0;
  double now_s_ = 0.0;
  State state_;
  LoopSummary summary_;
  const std::atomic<bool>& stop_;
};

}  // namespace

LoopSummary run_lockstep(const Config& config, const std::string& lcm_url, const std::atomic<bool>& stop) {
  return std::make_unique<Lockstep>(config, lcm_url, stop)->run();
}

}  // namespace sidestep
