#include "firmware/io/cycle_runner.h"

namespace sidestep {
namespace {

constexpr double kRejectionShown_s = 5.0;

}  // namespace

CycleRunner::CycleRunner(const Config& config, Wire& wire, Blackbox& blackbox, Adviser& adviser, bool lockstep,
                         int standing)
    : model_(config.model),
      wire_(wire),
      blackbox_(blackbox),
      adviser_(adviser),
      lockstep_(lockstep),
      standing_(standing) {
  timing_.period_s = model_.settings.period_s();
  timing_.realtime = !lockstep && !(standing & kLimitingNotRealtime);
}

void CycleRunner::run(const Post& post, const Occasion& occasion) {
  clock_.start();
  KeptCycle kept;
  Moment& moment = kept.moment;
  moment.utime = occasion.utime;
  moment.seq = ++timing_.cycles;
  moment.now_s = occasion.now_s;
  moment.inputs = {post.arm.latest(),       post.target.latest(), post.obstacles.latest(),
                   occasion.skipped_cycles, occasion.stop,        occasion.foreign_command_s};
  if (const Guide* guide = adviser_.latest()) {
    moment.guide = *guide;
    moment.inputs.guide = &moment.guide;
  }
  moment.state = state_;
  const Result result = step(model_, state_, moment.inputs, moment.now_s, &clock_);
  state_ = result.next;

  // In lockstep every arm state has its answer.
  kept.commanded = result.commanding || lockstep_;
  kept.command = result.command;
  if (kept.commanded) wire_.publish(kept.command, moment.utime, moment.seq);
  const Latest<ArmState>& arm = moment.inputs.arm;
  if (arm.fresh(moment.now_s, model_.settings.ages.arm_state_s)) wire_.publish(*arm.message, moment.utime);

  kept.report = result.report;
  kept.report.limiting |= standing_ | (blackbox_.failed() ? kLimitingNoBlackbox : kLimitingNothing);
  timing_.skipped_cycles += occasion.skipped_cycles;
  kept.record = {moment.utime,
                 moment.seq,
                 clock_.stop(),
                 occasion.wake_latency_s,
                 timing_.skipped_cycles,
                 occasion.rejected_messages,
                 reason_to_show(occasion)};
  wire_.publish(kept.report, kept.record);
  blackbox_.keep(post, kept);
  adviser_.tell(moment.inputs, state_, moment.now_s);
  if (!lockstep_) publish_timing(occasion);
}

const char* CycleRunner::reason_to_show(const Occasion& occasion) {
  if (occasion.rejected_messages != rejected_messages_) rejected_s_ = occasion.now_s;
  rejected_messages_ = occasion.rejected_messages;
  return occasion.now_s - rejected_s_ <= kRejectionShown_s ? occasion.rejected_reason : "";
}

void CycleRunner::publish_timing(const Occasion& occasion) {
  timing_.wake_latency.add(occasion.wake_latency_s);
  if (occasion.now_s - timing_published_s_ < 1.0) return;
  timing_published_s_ = occasion.now_s;
  wire_.publish(timing_, occasion.utime);
}

}  // namespace sidestep
