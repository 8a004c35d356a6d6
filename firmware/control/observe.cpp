#include "firmware/control/observe.h"

#include <algorithm>

namespace sidestep {
namespace {

constexpr int kMostSkippedCycles = 3;  // in a row; more than a hiccup

/// Whether an arm can have come from one state to the next. One period and a sensor's noise are granted on top.
bool reachable(const Model& model, const State& before, const ArmState& arm) {
  const double dt_s = static_cast<double>(arm.utime - before.arm_utime) * 1e-6;
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

/// Returns false when a new arm state contradicts the one before.
bool follow_arm(const Model& model, const Latest<ArmState>& arm, double now_s, State& next) {
  if (arm.count == next.arm_count) return true;
  const bool first = next.arm_count == 0;
  const bool gap = arm.received_s - next.arm_received_s > model.settings.ages.arm_state_lost_s;
  const bool agrees = first || reachable(model, next, *arm.message);
  if (first || gap || !agrees) next.consistent_since_s = now_s;
  if (speaks_anew(model.settings.start_guard_s, arm, next)) next.arm_started_s = arm.received_s;
  next.arm_count = arm.count;
  next.arm_received_s = arm.received_s;
  next.arm_utime = arm.message->utime;
  next.arm_position_rad = arm.message->position_rad;
  return agrees || gap;
}

}  // namespace

Facts observe(const Model& model, const Inputs& inputs, double now_s, State& next) {
  const Ages& ages = model.settings.ages;
  const double rounding_s = 1e-9;
  Facts facts;
  facts.arm_known = inputs.arm.message != nullptr;
  if (facts.arm_known) {
    facts.arm_broke = !follow_arm(model, inputs.arm, now_s, next);
    facts.arm_starting = now_s - next.arm_started_s < model.settings.start_guard_s;
    facts.arm_fresh = inputs.arm.fresh(now_s, ages.arm_state_s);
    facts.arm_lost = !inputs.arm.fresh(now_s, ages.arm_state_lost_s);
    if (facts.arm_lost) next.consistent_since_s = now_s;
    facts.arm_consistent = now_s - next.consistent_since_s >= ages.consistent_s - rounding_s;
  }
  const bool none_needed = !inputs.obstacles.message && !model.settings.wait_for_obstacles;
  facts.obstacles_known = inputs.obstacles.message || none_needed;
  facts.obstacles_fresh = none_needed || inputs.obstacles.fresh(now_s, ages.obstacles_s);
  facts.target_known = inputs.target.message != nullptr;
  facts.target_fresh = inputs.target.fresh(now_s, ages.target_s);

  next.skipped_in_a_row = inputs.skipped_cycles > 0 ? next.skipped_in_a_row + inputs.skipped_cycles : 0;
  facts.late = next.skipped_in_a_row >= kMostSkippedCycles;
  facts.stop = inputs.stop;
  facts.rival = now_s - inputs.foreign_command_s <= ages.consistent_s;
  return facts;
}

}  // namespace sidestep
