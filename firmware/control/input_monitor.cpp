#include "firmware/control/input_monitor.h"

#include <algorithm>
#include <cmath>

#include "firmware/control/message_order.h"
#include "firmware/model/reach.h"

namespace sidestep {
namespace {

constexpr int kMaxSkippedCycles = 3;       // in a row; a single late wake-up skips one or two
constexpr double kArmWaits_s = 0.05;       // an arm without commands for longer stops on its own (the plant's contract)
constexpr double kSensorNoise_rad = 1e-3;  // 1 mrad, or 1 mm
constexpr double kRounding_s = 1e-9;

/// Whether the arm can have come from this state to the other within dt_s and one period.
bool reachable(const Model& model, const ArmState& from, const ArmState& arm, double dt_s) {
  if (dt_s <= 0.0) return false;
  const JointVector step_rad = (arm.position_rad - from.position_rad).cwiseAbs();
  const JointVector allowed_rad = model.arm.limits.velocity_radps * (dt_s + model.settings.period_s()) +
                                  JointVector::Constant(step_rad.size(), kSensorNoise_rad);
  return (step_rad.array() <= allowed_rad.array()).all();
}

/// Whether this may be the first state of another driver: its clock started over, or no state came for longer than
/// the start guard.
bool is_new_driver(double start_guard_s, const Latest<ArmState>& arm, const ArmMonitor& before) {
  return before.count == 0 || arm.message->utime < before.accepted.state.utime ||
         arm.received_s - before.received_s > start_guard_s;
}

/// A limit for the time between two arm states as the cycles see them; at least one and a half periods.
double longest_gap_s(const Model& model, double limit_s) {
  return std::max(limit_s, 1.5 * model.settings.period_s());
}

/// Time from an accepted state to a newer one, s.
double elapsed_since(const AcceptedArmState& from, const Latest<ArmState>& arm, double lost_s) {
  return sent_apart_s(from.state.utime, arm.message->utime, arm.received_s - from.received_s, lost_s);
}

/// Compares a new arm state with the accepted ones and accepts it unless it is an outlier. There is an accepted one.
void compare_arm(const Model& model, const Latest<ArmState>& arm, double now_s, ArmMonitor& monitor,
                 MonitorResult& result) {
  const AcceptedArmState &last = monitor.accepted, &before = monitor.before;
  const double lost_s = longest_gap_s(model, model.settings.timeouts.arm_state_lost_s);
  const double by_receipt_s = arm.received_s - last.received_s;
  const double elapsed_s = elapsed_since(last, arm, lost_s);
  const bool clock_back = elapsed_s <= 0.0;
  const bool silence = arm.received_s - monitor.received_s > lost_s;
  const bool gap = by_receipt_s > lost_s;
  const bool agrees = reachable(model, last.state, *arm.message, elapsed_s);
  if (gap || !agrees) monitor.consistent_since_s = now_s;

  const bool bridges = model.settings.bridges_outliers && !clock_back;
  const bool outliers_persist = gap && !silence && !agrees;
  result.status.arm_inconsistent = outliers_persist || (!agrees && !gap && !bridges);
  if (silence || !bridges)
    result.continuity.arm_follows = reachable(model, last.state, *arm.message, std::max(by_receipt_s, elapsed_s));
  const bool outlier =
      !agrees && !gap && bridges && !reachable(model, before.state, *arm.message, elapsed_since(before, arm, lost_s));
  if (outlier) return;
  monitor.rate_radps = JointVector::Zero(model.arm.joints);
  if (elapsed_s > 0.0) monitor.rate_radps = (arm.message->position_rad - last.state.position_rad) / elapsed_s;
  monitor.before = last;
  monitor.accepted = {*arm.message, arm.received_s};
}

/// Takes a new arm state into the monitor; without a new one nothing changes. Returns the time without an arm state
/// before it, on the clock of the cycles, which stands still between two states in lockstep.
double update_arm(const Model& model, const Latest<ArmState>& arm, double now_s, ArmMonitor& monitor,
                  MonitorResult& result) {
  if (arm.count == monitor.count) return 0.0;
  const bool first = monitor.count == 0;
  // States that came in between were received in time, but not read: then there was no silence.
  const bool next_in_count = !first && arm.count == monitor.count + 1;
  const double silence_s = next_in_count ? std::min(arm.received_s - monitor.received_s, now_s - monitor.cycle_s) : 0.0;
  if (is_new_driver(model.settings.start_guard_s, arm, monitor)) monitor.driver_started_s = arm.received_s;
  if (first) {
    monitor.consistent_since_s = now_s;
    monitor.rate_radps = JointVector::Zero(model.arm.joints);
    monitor.before = monitor.accepted = {*arm.message, arm.received_s};
  } else {
    compare_arm(model, arm, now_s, monitor, result);
  }
  monitor.count = arm.count;
  monitor.received_s = arm.received_s;
  return silence_s;
}

void monitor_arm(const Model& model, const Latest<ArmState>& arm, double now_s, ArmMonitor& monitor,
                 MonitorResult& result) {
  InputStatus& status = result.status;
  const Timeouts& timeouts = model.settings.timeouts;
  const double silence_s = update_arm(model, arm, now_s, monitor, result);
  const auto in_time = [&](double limit_s) {
    const double age_s = now_s - monitor.accepted.received_s;
    return age_s >= 0.0 && age_s <= limit_s && silence_s <= longest_gap_s(model, limit_s);
  };
  status.arm_starting = now_s - monitor.driver_started_s < model.settings.start_guard_s;
  status.arm_fresh = in_time(timeouts.arm_state_s);
  status.arm_lost = !in_time(timeouts.arm_state_lost_s);
  if (status.arm_lost) monitor.consistent_since_s = now_s;
  status.arm_consistent = now_s - monitor.consistent_since_s >= timeouts.consistent_s - kRounding_s;
  result.continuity.arm_received_s = monitor.accepted.received_s;
}

/// Whether the goal can be reached at all, as far as that is known.
void examine_goal(const Model& model, const Target& target, const Guide* guide, InputStatus& status) {
  const GoalFinding found = guide ? guide->goal : GoalFinding::kNone;
  if (!target.is_posture()) {
    status.target_out_of_reach = found == GoalFinding::kOutOfReach || is_beyond_reach(model.arm, target.position_m);
    return;
  }
  const JointLimits& limits = model.arm.limits;
  status.posture_blocked = found == GoalFinding::kPostureBlocked;
  status.posture_outside_limits = (target.posture_rad.array() < limits.lower_rad.array()).any() ||
                                  (target.posture_rad.array() > limits.upper_rad.array()).any();
}

}  // namespace

MonitorResult monitor_inputs(const Model& model, const Inputs& inputs, double now_s, ArmMonitor& monitor) {
  const Timeouts& timeouts = model.settings.timeouts;
  MonitorResult result;
  InputStatus& status = result.status;
  ArmContinuity& continuity = result.continuity;
  const double waits_s = longest_gap_s(model, kArmWaits_s);
  continuity.cycles_paused = now_s - monitor.cycle_s > waits_s + kRounding_s;
  continuity.arm_waited_until_s = monitor.cycle_s + waits_s;
  continuity.clock_went_back = now_s < monitor.cycle_s;
  status.arm_known = inputs.arm.message != nullptr;
  if (status.arm_known) monitor_arm(model, inputs.arm, now_s, monitor, result);
  monitor.cycle_s = now_s;

  const bool none_required = !inputs.obstacles.message && !model.settings.wait_for_obstacles;
  status.obstacles_known = inputs.obstacles.message || none_required;
  status.obstacles_fresh = none_required || inputs.obstacles.fresh(now_s, timeouts.obstacles_s);
  status.target_known = inputs.target.message != nullptr;
  status.target_fresh = inputs.target.fresh(now_s, timeouts.target_s);
  if (inputs.target.message) examine_goal(model, *inputs.target.message, inputs.guide, status);

  monitor.skipped_in_a_row = inputs.skipped_cycles > 0 ? monitor.skipped_in_a_row + inputs.skipped_cycles : 0;
  status.late = monitor.skipped_in_a_row >= kMaxSkippedCycles;
  const Control control = inputs.control.message ? *inputs.control.message : Control{};
  status.stop = inputs.stop || control.command == ControlCommand::kStop;
  status.paused = control.command == ControlCommand::kPause;
  status.operator_silent = timeouts.control_s > 0.0 && !inputs.control.fresh(now_s, timeouts.control_s);
  result.speed_scale = status.paused || status.operator_silent ? 0.0 : control.speed_scale;
  status.foreign_command = now_s - inputs.foreign_command_s <= timeouts.consistent_s;
  return result;
}

}  // namespace sidestep
