#include "firmware/control/input_monitor.h"

#include <algorithm>
#include <cmath>

namespace sidestep {
namespace {

constexpr int kMostSkippedCycles = 3;  // in a row; more than a hiccup
constexpr double kArmWaits_s = 0.05;   // an arm that hears no command for longer stops by itself

/// Whether an arm can have come from one state to the next in this time. One period and a sensor's noise are granted on
/// top.
bool reachable(const Model& model, const State& before, const ArmState& arm, double dt_s) {
  if (dt_s <= 0.0) return false;
  const JointVector step_rad = (arm.position_rad - before.arm_position_rad).cwiseAbs();
  const JointVector allowed_rad = model.arm.limits.velocity_radps * (dt_s + model.settings.period_s()) +
                                  JointVector::Constant(step_rad.size(), 1e-3);
  return (step_rad.array() <= allowed_rad.array()).all();
}

/// Whether this may be the first state of another driver: its clock starts over, or it was silent for long.
bool speaks_anew(double silence_s, const Latest<ArmState>& arm, const State& before) {
  return before.arm_count == 0 || arm.message->utime < before.arm_utime ||
         arm.received_s - before.arm_received_s > silence_s;
}

/// A limit for the time between two arm states as the cycles see them; it cannot be less than a period.
double longest_gap_s(const Model& model, double limit_s) {
  return std::max(limit_s, 1.5 * model.settings.period_s());
}

/// What a new arm state tells about the time since the one before.
struct ArmNews {
  bool contradicts = false;  ///< no arm gets there in that time
  double silence_s = 0.0;    ///< before it, on a clock that stood still meanwhile, as in lockstep
};

ArmNews follow_arm(const Model& model, const Latest<ArmState>& arm, double now_s, State& next) {
  ArmNews news;
  if (arm.count == next.arm_count) return news;
  const bool first = next.arm_count == 0;
  const double by_receipt_s = arm.received_s - next.arm_received_s;
  const double lost_s = longest_gap_s(model, model.settings.timeouts.arm_state_lost_s);
  const bool gap = by_receipt_s > lost_s;
  const double elapsed_s = sent_apart_s(next.arm_utime, arm.message->utime, by_receipt_s, lost_s);
  const bool agrees = first || reachable(model, next, *arm.message, elapsed_s);
  if (first || gap || !agrees) next.consistent_since_s = now_s;
  news.contradicts = !agrees && !gap;
  // Were there others in between, it was this side that did not look.
  if (!first && arm.count == next.arm_count + 1) news.silence_s = std::min(by_receipt_s, now_s - next.cycle_s);
  // Commands do not go on from the last one when that does not lead this arm any more.
  if (next.commanding) next.commanding = reachable(model, next, *arm.message, std::max(by_receipt_s, elapsed_s));
  if (speaks_anew(model.settings.start_guard_s, arm, next)) next.arm_started_s = arm.received_s;
  next.arm_rate_radps = JointVector::Zero(model.arm.joints);
  if (!first && elapsed_s > 0.0) next.arm_rate_radps = (arm.message->position_rad - next.arm_position_rad) / elapsed_s;
  next.arm_count = arm.count;
  next.arm_received_s = arm.received_s;
  next.arm_utime = arm.message->utime;
  next.arm_position_rad = arm.message->position_rad;
  return news;
}

}  // namespace

InputStatus monitor_inputs(const Model& model, const Inputs& inputs, double now_s, State& next) {
  const Timeouts& timeouts = model.settings.timeouts;
  const double rounding_s = 1e-9;
  InputStatus status;
  // After a pause of this side commands do not go on from the last one: the arm has begun to stop by itself.
  const double waits_s = longest_gap_s(model, kArmWaits_s);
  if (next.commanding && now_s - next.cycle_s > waits_s + rounding_s) {
    next.commanding = false;
    next.stopped_s = next.cycle_s + waits_s + model.settings.period_s();  // as far as arm states tell
  }
  if (now_s < next.cycle_s) next.stopped_s = -HUGE_VAL;  // the clock has started over
  status.arm_known = inputs.arm.message != nullptr;
  if (status.arm_known) {
    const ArmNews news = follow_arm(model, inputs.arm, now_s, next);
    const auto in_time = [&](double limit_s) {
      return inputs.arm.fresh(now_s, limit_s) && news.silence_s <= longest_gap_s(model, limit_s);
    };
    status.arm_inconsistent = news.contradicts;
    status.arm_starting = now_s - next.arm_started_s < model.settings.start_guard_s;
    status.arm_fresh = in_time(timeouts.arm_state_s);
    status.arm_lost = !in_time(timeouts.arm_state_lost_s);
    if (status.arm_lost) next.consistent_since_s = now_s;
    status.arm_consistent = now_s - next.consistent_since_s >= timeouts.consistent_s - rounding_s;
  }
  next.cycle_s = now_s;
  const bool none_needed = !inputs.obstacles.message && !model.settings.wait_for_obstacles;
  status.obstacles_known = inputs.obstacles.message || none_needed;
  status.obstacles_fresh = none_needed || inputs.obstacles.fresh(now_s, timeouts.obstacles_s);
  status.target_known = inputs.target.message != nullptr;
  status.target_fresh = inputs.target.fresh(now_s, timeouts.target_s);

  next.skipped_in_a_row = inputs.skipped_cycles > 0 ? next.skipped_in_a_row + inputs.skipped_cycles : 0;
  status.late = next.skipped_in_a_row >= kMostSkippedCycles;
  status.stop = inputs.stop;
  status.foreign_command = now_s - inputs.foreign_command_s <= timeouts.consistent_s;
  return status;
}

}  // namespace sidestep
