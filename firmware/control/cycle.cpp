#include "firmware/control/cycle.h"

#include <algorithm>
#include <cmath>

#include "firmware/control/extrapolation.h"
#include "firmware/control/guided_law.h"
#include "firmware/control/input_monitor.h"
#include "firmware/control/paper/paper_law.h"
#include "firmware/control/shield/shield.h"
#include "firmware/control/sidestep_law.h"
#include "firmware/model/velocity_range.h"

namespace sidestep {
namespace {

/// The velocity that both the arm's own words and its positions speak for: the lesser, and rest where they contradict.
double minmod(double said_radps, double seen_radps) {
  if (said_radps * seen_radps <= 0.0) return 0.0;
  return std::abs(said_radps) < std::abs(seen_radps) ? said_radps : seen_radps;
}

/// A new stream of commands starts from where the arm is held, so that nothing jumps; a running one goes on from its
/// last.
void start_from(const Model& model, const ArmState& arm, State& next) {
  const JointVector& fastest = model.arm.limits.velocity_radps;
  next.position_rad = arm.held_rad.size() > 0 ? arm.held_rad : arm.position_rad;
  next.velocity_radps = arm.velocity_radps.binaryExpr(next.arm_rate_radps, &minmod);
  next.velocity_radps = next.velocity_radps.cwiseMax(-fastest).cwiseMin(fastest);
  next.rate_radps = next.velocity_radps;
  next.planning = false;
}

/// The paper's law knows no guide.
const Guide* guide_to_follow(const Model& model, const Inputs& inputs) {
  const bool has_way = inputs.guide && inputs.guide->knots > 0;
  return has_way && model.settings.law == Law::kSidestep ? inputs.guide : nullptr;
}

/// The joint velocity that the law wishes for; at rest unless tracking.
NominalCommand evaluate_law(const Model& model, const Situation& situation, const State& state, const Guide* guide,
                            double now_s) {
  if (state.supervision.mode != Mode::kTrack) return {JointVector::Zero(model.arm.joints)};
  const SidestepGains& gains = model.settings.sidestep;
  if (guide) return guided_law(gains, situation, *guide, now_s);
  if (model.settings.law == Law::kSidestep)
    return sidestep_law(gains, situation, away_from_limits(gains, model.arm.limits, situation.position_rad));
  const Vector3* planned = state.planning ? &state.planned_mps : nullptr;
  return paper_law(model.settings.paper, model.settings.period_s(), situation, planned);
}

/// How far the command of a joint has to close in on the measured arm, rad: by what is beyond half the following error,
/// so that a command that can catch up is never held back by it; and altogether from an arm that has been moved.
double catch_up(const Model& model, const State& state, const ArmState& arm, int joint) {
  const double following_error_rad = model.settings.following_error_rad, granted_rad = 0.5 * following_error_rad;
  const double error_rad = arm.position_rad[joint] - state.position_rad[joint];
  if (std::abs(error_rad) > following_error_rad) return error_rad;
  return error_rad - std::clamp(error_rad, -granted_rad, granted_rad);
}

/// How fast the commanded position of a joint moves, rad/s: with the velocity, and where the arm has fallen too far
/// behind or been moved closer to it, but as a joint could.
double commanded_rate(const Model& model, const State& state, const ArmState& arm, int joint, double velocity_radps) {
  const double gap_rad = moves(state.supervision.mode) ? catch_up(model, state, arm, joint) : 0.0;
  const double last_radps = state.rate_radps[joint];
  if (gap_rad == 0.0 && last_radps == state.velocity_radps[joint]) return velocity_radps;
  const double period_s = model.settings.period_s(), acceleration_radps2 = model.arm.limits.acceleration_radps2[joint];
  const double fastest_radps = model.arm.limits.velocity_radps[joint], change_radps = acceleration_radps2 * period_s;
  const double closer_radps = velocity_radps + stopping_velocity(gap_rad, acceleration_radps2, period_s);
  return std::clamp(std::clamp(closer_radps, -fastest_radps, fastest_radps), last_radps - change_radps,
                    last_radps + change_radps);
}

/// Where the rate leads from the last commanded position.
JointVector lead(const Model& model, const State& state, const JointVector& rate_radps) {
  const JointLimits& limits = model.arm.limits;
  JointVector position_rad = state.position_rad + rate_radps * model.settings.period_s();
  for (int i = 0; i < model.arm.joints; ++i) {
    // Rounding only; an arm that is outside its limits is led back, not pulled.
    const bool inside = state.position_rad[i] >= limits.lower_rad[i] && state.position_rad[i] <= limits.upper_rad[i];
    if (inside) position_rad[i] = std::clamp(position_rad[i], limits.lower_rad[i], limits.upper_rad[i]);
  }
  return position_rad;
}

/// The velocities that the joint limits leave for the coming period, wherever between command and measurement the arm
/// is. The command may not lead the arm on by more than the following error either: an arm that is held fast stops it.
VelocityRange next_range(const Model& model, const State& state, const ArmState& arm) {
  const double period_s = model.settings.period_s();
  JointLimits limits = model.arm.limits;
  JointVector position_rad = state.position_rad;
  for (int i = 0; i < model.arm.joints; ++i) {
    const double velocity_radps = state.velocity_radps[i];
    position_rad[i] += (commanded_rate(model, state, arm, i, velocity_radps) - velocity_radps) * period_s;
    const double behind_rad = arm.position_rad[i] - model.settings.following_error_rad;
    const double ahead_rad = arm.position_rad[i] + model.settings.following_error_rad;
    limits.lower_rad[i] = std::max(limits.lower_rad[i], std::min(behind_rad, position_rad[i]));
    limits.upper_rad[i] = std::min(limits.upper_rad[i], std::max(ahead_rad, position_rad[i]));
  }
  return velocity_range(limits, position_rad.cwiseMin(arm.position_rad), position_rad.cwiseMax(arm.position_rad),
                        state.velocity_radps, period_s);
}

/// Far from the target there are many ways, so a comfortable one is worth a detour; at the target the tool comes first.
/// A guide is a detour already.
double comfort_weight(const ShieldSettings& shield, const Situation& situation, Mode mode, bool guided) {
  if (mode != Mode::kTrack || guided) return shield.comfort_least_weight;
  const double distance_m = (situation.target.position_m - situation.poses.tool_position).norm();
  const double share = (distance_m - shield.comfort_near_m) / (shield.comfort_far_m - shield.comfort_near_m);
  return shield.comfort_least_weight +
         std::clamp(share, 0.0, 1.0) * (shield.comfort_weight - shield.comfort_least_weight);
}

/// The wish made safe: by the shield where it is on, else left to the limits alone.
JointVector keep_clear(const Model& model, const Situation& situation, const ArmState& arm, const VelocityRange& range,
                       const NominalCommand& wish, bool guided, State& state) {
  const Settings& settings = model.settings;
  const Mode mode = state.supervision.mode;
  if (settings.law == Law::kPaper || !settings.shield.enabled) return wish.velocity_radps;
  if (!moves(mode)) return wish.velocity_radps;
  const ShieldInput around{model.arm,           situation.poses,
                           arm.position_rad,    state.velocity_radps,
                           situation.clearance, situation.obstacles,
                           model.self_pairs,    state.evasion_radps,
                           settings.period_s(), comfort_weight(settings.shield, situation, mode, guided)};
  const VelocityRange sustainable =
      sustainable_range(model.arm.limits, arm.position_rad, arm.position_rad, settings.period_s());
  const Shielded safe =
      shield(settings.shield, around, sustainable, range, situation.tool_jacobian, wish.velocity_radps);
  state.evasion_radps = safe.plan.evading ? safe.plan.velocity_radps : JointVector();
  return safe.velocity_radps;
}

/// The last word before a command leaves: within all limits, or braking.
Command gate(const Model& model, const ArmState& arm, const VelocityRange& range, JointVector velocity_radps,
             State& next, int& limiting) {
  const double period_s = model.settings.period_s();
  const JointLimits& limits = model.arm.limits;
  if (moves(next.supervision.mode))
    limiting |= apply_limits(limits, range, next.velocity_radps, period_s, velocity_radps);
  else
    velocity_radps = brake(limits, next.velocity_radps, period_s);
  for (int i = 0; i < model.arm.joints; ++i)
    next.rate_radps[i] = commanded_rate(model, next, arm, i, velocity_radps[i]);
  return {lead(model, next, next.rate_radps), velocity_radps};
}

/// A stream of commands starts from where the arm is, not from where it was before it stopped by itself. It runs in
/// every mode that moves the arm, and after a fault until the arm is at rest.
bool stream_continues(const State& state, const InputStatus& status) {
  if (status.arm_starting || state.supervision.mode == Mode::kWait) return false;
  const bool heard = status.arm_fresh && state.arm_received_s > state.stopped_s;
  if (!state.commanding && !heard) return false;
  if (state.supervision.mode == Mode::kFault) return !at_rest(state);
  return true;
}

/// A wish that is not finite is a defect somewhere: stop, and start over after a while of consistent arm state.
void latch_not_finite(double now_s, State& next) {
  next.supervision = {Mode::kFault, Fault::kNotFinite, "fault: a result was not finite"};
  next.consistent_since_s = now_s;
}

void remember(const Command& command, const NominalCommand& wish, const InputStatus& status, State& next) {
  next.position_rad = command.position_rad;
  next.velocity_radps = command.velocity_radps;
  next.planning = next.supervision.mode == Mode::kTrack;
  next.planned_mps = wish.tool_velocity_mps;
  next.commanding = stream_continues(next, status);
}

void report_tool(const Situation& situation, Report& report) {
  report.tool_position_m = situation.poses.tool_position;
  report.tool_velocity_mps = situation.tool_jacobian.topRows<3>() * situation.velocity_radps;
}

void report_guide(Mode mode, const Guide* guide, double now_s, Report& report) {
  if (!guide || mode != Mode::kTrack) return;
  report.foresight_status = guide->foresight_status;
  report.guide_horizon_s = std::max(0.0, guide->end_s() - now_s);
  if (guide->knots > 0) report.guide = guide;
}

void report_clearance(const Clearance& clearance, const ObstacleView& obstacles, Report& report) {
  if (!obstacles.set && obstacles.count() == 0) return;
  report.clearance_m = clearance.nearest.distance_m;
  report.nearest_shape = clearance.nearest.shape;
  if (clearance.nearest.obstacle >= 0) report.nearest_obstacle = obstacles.at(clearance.nearest.obstacle).id;
}

}  // namespace

bool at_rest(const State& state) {
  return !state.commanding || (state.velocity_radps.isZero(0.0) && state.rate_radps.isZero(0.0));
}

Result step(const Model& model, const State& state, const Inputs& inputs, double now_s, StageProbe* probe) {
  const auto passed = [probe](Stage stage) {
    if (probe) probe->passed(stage);
  };
  Result result;
  Report& report = result.report;
  State& next = result.next = state;

  const InputStatus status = monitor_inputs(model, inputs, now_s, next);
  next.supervision = next_mode(state.supervision, status);
  const bool streaming = next.commanding = next.commanding && !status.arm_starting;
  if (status.arm_known) {
    const ArmState& arm = *inputs.arm.message;
    if (!streaming) start_from(model, arm, next);

    const LinkPoses poses = forward_kinematics(model.arm, arm.position_rad);
    passed(Stage::kObserve);
    const ObstacleView obstacles = view_obstacles(model, inputs.obstacles, now_s);
    const Reach reach{model.settings.shield.range_m, model.settings.shield.pass_horizon_s};
    const Clearance clearance = measure_clearance(model.arm, poses, obstacles, reach);
    passed(Stage::kClearance);
    const Target target = inputs.target.message ? extrapolated(inputs.target, now_s) : Target{};

    const TaskJacobian jacobian = tool_jacobian(poses, target.tracks_orientation ? 6 : 3);
    const Situation situation{model.arm,          poses,  jacobian,  arm.position_rad,
                              arm.velocity_radps, target, obstacles, clearance};
    const Guide* guide = guide_to_follow(model, inputs);
    const NominalCommand wish = evaluate_law(model, situation, next, guide, now_s);
    passed(Stage::kLaw);
    const VelocityRange range = next_range(model, next, arm);
    const JointVector safe = keep_clear(model, situation, arm, range, wish, guide != nullptr, next);
    passed(Stage::kShield);
    if (!safe.allFinite()) latch_not_finite(now_s, next);
    result.command = gate(model, arm, range, safe, next, report.limiting);
    remember(result.command, wish, status, next);
    passed(Stage::kGate);

    report_guide(next.supervision.mode, inputs.guide, now_s, report);
    report_tool(situation, report);
    report_clearance(clearance, obstacles, report);
    if (inputs.target.message) report.target_distance_m = (target.position_m - poses.tool_position).norm();
    report.shield_correction_radps = (safe - wish.velocity_radps).norm();
    if (report.shield_correction_radps > 1e-6) report.limiting |= kLimitingShield;
    report.beta = wish.beta;
    report.damping = wish.damping;
    if (wish.task_speed_limited) report.limiting |= kLimitingTaskSpeed;
  }
  if (inputs.skipped_cycles > 0) report.limiting |= kLimitingLate;
  report.mode = next.supervision.mode;
  report.fault = next.supervision.fault;
  report.message = next.supervision.message;
  result.commanding = next.commanding || (streaming && report.mode == Mode::kFault);  // rest is said too
  return result;
}

}  // namespace sidestep
