#include <cmath>
#include <memory>

#include "firmware/base/realtime.h"
#include "firmware/io/lcm/admission.h"
#include "firmware/io/lcm/obstacle_merger.h"
#include "firmware/io/loop/cycle_runner.h"
#include "firmware/io/loop/loop.h"

namespace sidestep {
namespace {

// Asked to stop, the loop waits this long for the next arm state before it ends.
constexpr double kFarewell_s = 0.5;

class Lockstep {
 public:
  Lockstep(const Config& config, const std::string& lcm_url, Requests& requests)
      : blackbox_(config, requests.write_blackbox),
        foresight_thread_(config.model, true),
        wire_(lcm_url, config),
        runner_(config, wire_, blackbox_, foresight_thread_, true, kLimitingNothing),
        admission_(config.model.arm.joints, config.model.settings, true),
        obstacle_merger_(config),
        obstacles_(std::make_unique<Pending<ObstacleSet>>()),
        stop_(requests.stop) {
    wire_.on_arm_state([this](const void* bytes, size_t size) { cycle(bytes, size); });
    wire_.on_target([this](const void* bytes, size_t size) { receive(bytes, size, target_); });
    wire_.on_obstacles([this](const void* bytes, size_t size) { join(0, bytes, size); });
    wire_.on_foreign_command(true, [this] { foreign_command_s_ = now_s_; });
    for (size_t k = 0; k < config.neighbours.listen.size(); ++k)
      wire_.on_neighbour(k, [this, k](const void* bytes, size_t size) { join(k + 1, bytes, size); });
  }

  LoopSummary run() {
    double last_cycle_s = monotonic_s();
    while (!(stop_ && runner_.at_rest())) {
      const int64_t cycles = runner_.timing().cycles;
      wire_.receive(50);
      if (runner_.timing().cycles != cycles || !stop_) last_cycle_s = monotonic_s();
      if (monotonic_s() - last_cycle_s > kFarewell_s) break;
    }
    return {runner_.timing(), rejected_};
  }

 private:
  /// A message between two cycles: it was received when the next one begins. Two slots, so that a rejected message
  /// does not spoil the one in use.
  template <typename Message>
  struct Pending {
    Received<Message> slots[2];
    int current = 0;
    bool arrived = false;
    double age_s = 0.0;  ///< when it arrived

    Received<Message>& mail() { return slots[current]; }

    const Received<Message>& take(double now_s) {
      if (arrived) mail().received_s = now_s - age_s;
      arrived = false;
      return mail();
    }
  };

  template <typename Message>
  bool receive(const void* bytes, size_t size, Pending<Message>& pending) {
    Received<Message>& spare = pending.slots[1 - pending.current];
    const bool admitted = admission_.admit(bytes, size, now_s_, spare.message);
    count_rejected(admission_);
    if (!admitted) return false;
    const auto* first = static_cast<const uint8_t*>(bytes);
    spare.bytes.assign(first, first + size);
    spare.count = pending.mail().count + 1;
    pending.current = 1 - pending.current;
    return pending.arrived = true;
  }

  void join(size_t part, const void* bytes, size_t size) {
    const auto whole = obstacle_merger_.join(part, bytes, size, now_s_);
    if (!whole) return count_rejected(obstacle_merger_);
    if (receive(whole->packet.bytes, whole->packet.size, *obstacles_)) obstacles_->age_s = whole->age_s;
  }

  /// After a message that went no farther than this gate.
  template <typename Gate>
  void count_rejected(const Gate& gate) {
    const int64_t count = admission_.rejected() + obstacle_merger_.rejected();
    if (count > rejected_) rejected_reason_ = gate.last_reason();
    rejected_ = count;
  }

  void cycle(const void* bytes, size_t size) {
    if (!receive(bytes, size, arm_)) return;
    CycleRunner::CycleTrigger trigger;
    trigger.utime = arm_.mail().message.utime;
    trigger.now_s = now_s_ = static_cast<double>(trigger.utime) * 1e-6;
    trigger.stop = stop_;
    if (foreign_command_s_ > now_s_) foreign_command_s_ = -HUGE_VAL;  // the clock has started over
    trigger.foreign_command_s = foreign_command_s_;
    trigger.rejected_messages = rejected_;
    trigger.rejected_reason = rejected_reason_;
    runner_.run({arm_.take(now_s_), target_.take(now_s_), obstacles_->take(now_s_)}, trigger);
  }

  Blackbox blackbox_;
  ForesightThread foresight_thread_;
  Wire wire_;
  CycleRunner runner_;
  Admission admission_;
  ObstacleMerger obstacle_merger_;
  Pending<ArmState> arm_;
  Pending<Target> target_;
  std::unique_ptr<Pending<ObstacleSet>> obstacles_;
  double now_s_ = 0.0;
  double foreign_command_s_ = -HUGE_VAL;
  int64_t rejected_ = 0;
  const char* rejected_reason_ = "";
  const std::atomic<bool>& stop_;
};

}  // namespace

LoopSummary run_lockstep(const Config& config, const std::string& lcm_url, Requests& requests) {
  return std::make_unique<Lockstep>(config, lcm_url, requests)->run();
}

}  // namespace sidestep
