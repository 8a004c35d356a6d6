#include "firmware/io/loop/cycle_runner.h"

#include "firmware/control/extrapolation.h"

namespace sidestep {
namespace {

constexpr double kRejectionShown_s = 5.0;

/// An input that need not have been received: `latest` points at its copy in `kept`.
template <typename Message>
void keep_newest(const Received<Message>& received, Latest<Message>& latest, Message& kept) {
  if (received.count == 0) return;
  latest = received.latest();
  kept = received.message;
  latest.message = &kept;
}

}  // namespace

CycleRunner::CycleRunner(const Config& config, Wire& wire, Blackbox& blackbox, ForesightThread& foresight_thread,
                         bool lockstep, int degraded)
    : model_(config.model),
      wire_(wire),
      blackbox_(blackbox),
      foresight_thread_(foresight_thread),
      lockstep_(lockstep),
      degraded_(degraded) {
  timing_.period_s = model_.settings.period_s();
  timing_.realtime = !lockstep && !(degraded & kLimitingNotRealtime);
}

void CycleRunner::run(const LatestInputs& latest, const CycleTrigger& trigger) {
  clock_.start();
  RecordedCycle cycle;
  StepArguments& arguments = cycle.arguments;
  arguments.utime = trigger.utime;
  arguments.seq = ++timing_.cycles;
  arguments.now_s = trigger.now_s;
  arguments.inputs = {latest.arm.latest(),    latest.target.latest(), latest.obstacles.latest(),
                      trigger.skipped_cycles, trigger.stop,           trigger.foreign_command_s};
  keep_newest(latest.other_joints, arguments.inputs.other_joints, arguments.other_joints);
  keep_newest(latest.attachments, arguments.inputs.attachments, arguments.attachments);
  keep_newest(latest.control, arguments.inputs.control, arguments.control);
  if (const Guide* guide = foresight_thread_.latest()) {
    arguments.guide = *guide;
    arguments.inputs.guide = &arguments.guide;
  }
  arguments.state = state_;
  const Result result = step(model_, state_, arguments.inputs, arguments.now_s, &clock_);
  state_ = result.next;

  cycle.commanded = result.commanding || lockstep_;  // in lockstep every arm state is answered
  cycle.command = result.command;
  if (cycle.commanded) wire_.publish(cycle.command, arguments.utime, arguments.seq);
  const AcceptedArmState& arm = state_.arm_monitor.accepted;
  const bool arm_fresh = trigger.now_s - arm.received_s <= model_.settings.timeouts.arm_state_s;
  if (state_.arm_monitor.count > 0 && arm_fresh)
    wire_.publish(arm.state, present_others(model_, arguments.inputs, trigger.now_s), arguments.utime);

  cycle.report = result.report;
  cycle.report.limiting |= degraded_ | (blackbox_.failed() ? kLimitingNoBlackbox : kLimitingNothing);
  timing_.skipped_cycles += trigger.skipped_cycles;
  cycle.record = {arguments.utime,        arguments.seq,          clock_.stop(),
                  trigger.wake_latency_s, timing_.skipped_cycles, trigger.rejected_messages,
                  reason_to_show(trigger)};
  wire_.publish(cycle.report, cycle.record);
  blackbox_.record(latest, cycle);
  foresight_thread_.submit(arguments.inputs, state_, arguments.now_s);
  if (!lockstep_) publish_timing(trigger);
}

const char* CycleRunner::reason_to_show(const CycleTrigger& trigger) {
  if (trigger.rejected_messages != rejected_messages_) rejected_s_ = trigger.now_s;
  rejected_messages_ = trigger.rejected_messages;
  return trigger.now_s - rejected_s_ <= kRejectionShown_s ? trigger.rejected_reason : "";
}

void CycleRunner::publish_timing(const CycleTrigger& trigger) {
  timing_.wake_latency.add(trigger.wake_latency_s);
  if (trigger.now_s - timing_published_s_ < 1.0) return;
  timing_published_s_ = trigger.now_s;
  timing_.reception = wire_.reception();
  wire_.publish(timing_, trigger.utime);
}

}  // namespace sidestep
