#include <cmath>
#include <memory>

#include "firmware/base/realtime.h"
#include "firmware/io/lcm/network_inputs.h"
#include "firmware/io/loop/cycle_runner.h"
#include "firmware/io/loop/loop.h"

namespace sidestep {
namespace {

constexpr double kWaitForArm_s = 0.5;  // after a stop request, until the loop ends without another arm state

class Lockstep {
 public:
  Lockstep(const Config& config, const std::string& lcm_url, Requests& requests)
      : blackbox_(config, requests.write_blackbox),
        foresight_thread_(config.model, true),
        wire_(lcm_url, config.wire()),
        runner_(config, wire_, blackbox_, foresight_thread_, true, kLimitingNothing),
        inputs_(config.model.settings, config.model.arm, *config.dialect, config.neighbours, true),
        obstacles_(std::make_unique<Pending<ObstacleSet>>()),
        stop_(requests.stop) {
    wire_.on_arm_state([this](Packet packet) { cycle(packet); });
    wire_.on_target([this](Packet packet) { receive(target_, packet); });
    wire_.on_joint_target([this](Packet packet) { receive_joint_target(packet); });
    wire_.on_other_joints([this](Packet packet) { receive(other_joints_, packet); });
    wire_.on_control([this, &requests](Packet packet) {
      if (receive(control_, packet) && control_.newest().message.command == ControlCommand::kStop) requests.stop = true;
    });
    wire_.on_attachments([this](Packet packet) { receive(attachments_, packet); });
    wire_.on_obstacles([this](Packet packet) { receive_obstacles(0, packet); });
    wire_.on_foreign_command(true, [this] { foreign_command_s_ = now_s_; });
    for (size_t k = 0; k < config.neighbours.listen.size(); ++k)
      wire_.on_neighbour(k, [this, k](Packet packet) { receive_obstacles(k + 1, packet); });
  }

  LoopSummary run() {
    double last_cycle_s = monotonic_s();
    while (!(stop_ && runner_.at_rest())) {
      const int64_t cycles = runner_.timing().cycles;
      wire_.receive(50);
      if (runner_.timing().cycles != cycles || !stop_) last_cycle_s = monotonic_s();
      if (monotonic_s() - last_cycle_s > kWaitForArm_s) break;
    }
    return {runner_.timing(), inputs_.rejected(), wire_.reception()};
  }

 private:
  /// The newest message of a channel. Its receipt time is that of the next cycle, less the age that it had on arrival.
  /// Two slots, so that a rejected message does not overwrite the one in use.
  template <typename Message>
  struct Pending {
    Received<Message> slots[2];
    int current = 0;
    bool arrived = false;
    double age_s = 0.0;  ///< on arrival

    Received<Message>& newest() { return slots[current]; }
    Received<Message>& draft() { return slots[1 - current]; }

    void take_draft(double at_s) {
      draft().count = newest().count + 1;
      age_s = at_s - draft().received_s;
      current = 1 - current;
      arrived = true;
    }
    const Received<Message>& take(double now_s) {
      if (arrived) newest().received_s = now_s - age_s;
      arrived = false;
      return newest();
    }
  };

  template <typename Message>
  bool receive(Pending<Message>& pending, Packet packet) {
    if (!inputs_.receive(packet, now_s_, pending.draft())) return false;
    pending.take_draft(now_s_);
    return true;
  }

  void receive_joint_target(Packet packet) {
    if (inputs_.receive_joint_target(packet, now_s_, target_.draft())) target_.take_draft(now_s_);
  }

  void receive_obstacles(size_t part, Packet packet) {
    if (inputs_.receive_obstacles(part, packet, now_s_, obstacles_->draft())) obstacles_->take_draft(now_s_);
  }

  void cycle(Packet packet) {
    if (!receive(arm_, packet)) return;
    CycleRunner::CycleTrigger trigger;
    trigger.utime = arm_.newest().message.utime;
    trigger.now_s = now_s_ = static_cast<double>(trigger.utime) * 1e-6;
    trigger.stop = stop_;
    if (foreign_command_s_ > now_s_) foreign_command_s_ = -HUGE_VAL;  // the arm's clock has started over
    trigger.foreign_command_s = foreign_command_s_;
    trigger.rejected_messages = inputs_.rejected();
    trigger.rejected_reason = inputs_.last_reason();
    runner_.run({arm_.take(now_s_), target_.take(now_s_), obstacles_->take(now_s_), other_joints_.take(now_s_),
                 control_.take(now_s_), attachments_.take(now_s_)},
                trigger);
  }

  Blackbox blackbox_;
  ForesightThread foresight_thread_;
  Wire wire_;
  CycleRunner runner_;
  NetworkInputs inputs_;
  Pending<ArmState> arm_;
  Pending<Target> target_;
  Pending<OtherJoints> other_joints_;
  Pending<Control> control_;
  Pending<Attachments> attachments_;
  std::unique_ptr<Pending<ObstacleSet>> obstacles_;
  double now_s_ = 0.0;  ///< of the last cycle
  double foreign_command_s_ = -HUGE_VAL;
  const std::atomic<bool>& stop_;
};

}  // namespace

LoopSummary run_lockstep(const Config& config, const std::string& lcm_url, Requests& requests) {
  return std::make_unique<Lockstep>(config, lcm_url, requests)->run();
}

}  // namespace sidestep
