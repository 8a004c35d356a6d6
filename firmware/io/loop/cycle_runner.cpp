#include "firmware/io/loop/cycle_runner.h"

namespace sidestep {
namespace {

constexpr double kRejectionShown_s = 5.0;

}  // namespace

CycleRunner::CycleRunner(const Config& config, Wire& wire, Blackbox& blackbox, ForesightThread& foresight_thread,
                         bool lockstep, int standing)
    : model_(config.model),
      wire_(wire),
      blackbox_(blackbox),
      foresight_thread_(foresight_thread),
      lockstep_(lockstep),
      standing_(standing) {
  timing_.period_s = model_.settings.period_s();
  timing_.realtime = !lockstep && !(standing & kLimitingNotRealtime);
}

void CycleRunner::run(const LatestInputs& post, const CycleTrigger& trigger) {
  clock_.start();
  RecordedCycle kept;
  StepArguments& arguments = kept.arguments;
  arguments.utime = trigger.utime;
  arguments.seq = ++timing_.cycles;
  arguments.now_s = trigger.now_s;
  arguments.inputs = {post.arm.latest(),      post.target.latest(), post.obstacles.latest(),
                      trigger.skipped_cycles, trigger.stop,         trigger.foreign_command_s};
  if (const Guide* guide = foresight_thread_.latest()) {
    arguments.guide = *guide;
    arguments.inputs.guide = &arguments.guide;
  }
  arguments.state = state_;
  const Result result = step(model_, state_, arguments.inputs, arguments.now_s, &clock_);
  state_ = result.next;

  // In lockstep every arm state has its answer.
  kept.commanded = result.commanding || lockstep_;
  kept.command = result.command;
  if (kept.commanded) wire_.publish(kept.command, arguments.utime, arguments.seq);
  const Latest<ArmState>& arm = arguments.inputs.arm;
  if (arm.fresh(arguments.now_s, model_.settings.timeouts.arm_state_s)) wire_.publish(*arm.message, arguments.utime);

  kept.report = result.report;
  kept.report.limiting |= standing_ | (blackbox_.failed() ? kLimitingNoBlackbox : kLimitingNothing);
  timing_.skipped_cycles += trigger.skipped_cycles;
  kept.record = {arguments.utime,        arguments.seq,          clock_.stop(),
                 trigger.wake_latency_s, timing_.skipped_cycles, trigger.rejected_messages,
                 reason_to_show(trigger)};
  wire_.publish(kept.report, kept.record);
  blackbox_.keep(post, kept);
  foresight_thread_.tell(arguments.inputs, state_, arguments.now_s);
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
  wire_.publish(timing_, trigger.utime);
}

}  // namespace sidestep
