#include "firmware/control/cycle.h"

#include <algorithm>
#include <optional>

#include "firmware/control/extrapolation.h"
#include "firmware/control/guided_law.h"
#include "firmware/control/paper/paper_law.h"
#include "firmware/control/posture_law.h"
#include "firmware/control/shield/shield.h"
#include "firmware/control/sidestep_law.h"
#include "firmware/control/task_compatibility.h"

namespace sidestep {
namespace {

/// The joint velocity that the law computes; zero unless tracking. In HOLD only a retreat is followed, because other
/// guides end at a target. guide_s: guide_time_s().
NominalCommand evaluate_law(const Model& model, const LawInput& input, const State& state, const Guide* guide,
                            double guide_s) {
  const Settings& settings = model.settings;
  if (state.supervision.mode == Mode::kHold && guide && guide->is_retreat())
    return guided_law(settings.sidestep, input, *guide, guide_s);
  if (state.supervision.mode != Mode::kTrack) return {JointVector::Zero(model.arm.joints)};
  const auto planned = state.planned.valid ? std::optional(state.planned.velocity_mps) : std::nullopt;
  if (settings.law == Law::kPaper) return paper_law(settings.paper, settings.period_s(), input, planned);
  if (guide) return guided_law(settings.sidestep, input, *guide, guide_s);
  if (input.target.is_posture()) return posture_law(settings.sidestep, input);
  const JointVector preferred_radps = away_from_limits(settings.sidestep, input) + toward_task_compatibility(input);
  return sidestep_law(settings.sidestep, input, preferred_radps);
}

/// How much the target's motion counts in the shield: from 0 at rest to 1 at 0.05 m/s and above. Only in TRACK: the
/// target that the arm no longer follows may be old.
double moving_share(const Target& target, Mode mode) {
  constexpr double kMoving_mps = 0.05;
  if (mode != Mode::kTrack) return 0.0;
  const double speed_mps = target.velocity_mps.norm() + kTurnWeight_m * target.angular_velocity_radps.norm();
  return std::min(1.0, speed_mps / kMoving_mps);
}

/// Weight of the tool's rotation in the shield's programme, m/rad: that of the law where the pose moves, 1 where it
/// rests, so that an arm that evades keeps a held object level.
double turn_weight_m(double moving) {
  return 1.0 - (1.0 - kTurnWeight_m) * moving;
}

/// How far the tool is from the target: 0 from comfort_near on, 1 from comfort_far on.
double far_share(const ShieldSettings& shield, const LawInput& input) {
  const double distance_m = (input.target.position_m - input.poses.tool_position).norm();
  return std::clamp((distance_m - shield.comfort_near_m) / (shield.comfort_far_m - shield.comfort_near_m), 0.0, 1.0);
}

constexpr double kLeastToolShare = 0.1;  // of tool_weight

// Of person_weight. With a tenth of it separation deflected some retreats back to where a limb was going to be: the
// campaign's two-people@camera had three times the contacts.
constexpr double kRetreatShare = 1e-4;

/// Share of the shield's tool_weight: all of it for a pose that moves and for a position near the tool. A tenth for a
/// position far away, to which a detour costs little; for a full pose at rest, where all of it led to contacts in the
/// campaign's dodge6d; for a posture; and while the arm makes room for a person, which it does with the tool as well.
double tool_weight_share(const ShieldSettings& shield, const LawInput& input, Mode mode, bool separates) {
  if (mode != Mode::kTrack || input.target.is_posture() || separates) return kLeastToolShare;
  const double counts =
      input.target.tracks_orientation ? moving_share(input.target, mode) : 1.0 - far_share(shield, input);
  return kLeastToolShare + (1.0 - kLeastToolShare) * counts;
}

NominalCommand scaled(NominalCommand nominal, double scale) {
  nominal.velocity_radps *= scale;
  nominal.tool_velocity_mps *= scale;
  return nominal;
}

/// Weight of the comfort tier, s2/m2. Far from the target a detour costs little, so comfort weighs much; at the target
/// the tool's task comes first. A guide keeps its own clearance. Where a posture is the goal, all joints have a task,
/// not only the tool with its tool_weight, and comfort near the goal would only keep the arm away from it.
double comfort_weight(const ShieldSettings& shield, const LawInput& input, Mode mode, bool guided) {
  const bool is_posture = mode == Mode::kTrack && input.target.is_posture();
  const double least = is_posture ? 1e-3 : shield.comfort_least_weight;
  const double divisor = is_posture ? std::max(1.0, kLeastToolShare * shield.tool_weight) : 1.0;
  const double largest = shield.comfort_weight / divisor;
  if (mode != Mode::kTrack || guided) return least;
  return least + far_share(shield, input) * (largest - least);
}

/// Weight of the separation from persons, s2/m2. A retreat may lead past one person, away from several: what it costs
/// to be near them on the way is part of the choice (rollout.h), and hard and pass rows hold on it as always.
double person_weight(const ShieldSettings& shield, Mode mode, bool retreats) {
  if (mode != Mode::kTrack) return 0.0;
  return retreats ? kRetreatShare * shield.person_weight : shield.person_weight;
}

/// The safe joint velocity; the nominal one where the shield is off or no stream can run. Updates the evasion, the
/// Limiting bits and the nearest links.
JointVector apply_shield(const Model& model, const LawInput& input, const VelocityRange& range,
                         const JointVector& nominal_radps, double comfort, double separation, State& state,
                         Report& report) {
  const Settings& settings = model.settings;
  const Mode mode = state.supervision.mode;
  const bool faulty_rollout = mode == Mode::kFault && !settings.bridges_outliers;  // a rollout ends there
  if (!settings.shield.enabled || mode == Mode::kWait || faulty_rollout) return nominal_radps;
  ShieldInput shield_input{model.arm,
                           input.poses,
                           input.position_rad,
                           state.stream.position_rad,
                           state.stream.velocity_radps,
                           input.clearance,
                           input.obstacles,
                           model.self_pairs,
                           state.evasion_radps,
                           settings.period_s(),
                           comfort,
                           settings.shield.tool_weight,
                           separation,
                           !moves(mode)};
  shield_input.tool_weight *= tool_weight_share(settings.shield, input, mode, keeps_separation(shield_input));
  // In a posture each joint has its own goal, and an arm that is to stop is at rest sooner where each brakes as it can.
  const bool tool_has_task = mode == Mode::kTrack && !input.target.is_posture();
  if (tool_has_task) shield_input.step_tool_weight = shield_input.tool_weight;
  const double turn_weight = turn_weight_m(moving_share(input.target, mode));
  const ShieldResult safe = shield(settings.shield, shield_input, input.sustainable, range,
                                   weighted_task(input.tool_jacobian, turn_weight), nominal_radps);
  if (safe.failed) report.limiting |= kLimitingShieldFailed;
  if (safe.links_limit) report.limiting |= kLimitingSelf;
  report.nearest_links = safe.nearest_links;
  state.evasion_radps = safe.plan.evading ? safe.plan.velocity_radps : JointVector();
  return safe.velocity_radps;
}

/// A result that is not finite is a defect: fault, until the arm state has been consistent for a while.
void latch_not_finite(double now_s, State& next) {
  next.supervision = {Mode::kFault, Fault::kNotFinite, "fault: a result was not finite"};
  next.arm_monitor.consistent_since_s = now_s;
}

void report_nominal(const NominalCommand& nominal, const JointVector& safe_radps, Report& report) {
  report.shield_correction_radps = (safe_radps - nominal.velocity_radps).norm();
  if (report.shield_correction_radps > 1e-6) report.limiting |= kLimitingShield;
  report.beta = nominal.beta;
  report.damping = nominal.damping;
  if (nominal.task_speed_limited) report.limiting |= kLimitingTaskSpeed;
}

void report_guide(Mode mode, const Guide* guide, double guide_s, Report& report) {
  if (!guide || !moves(mode)) return;
  report.foresight_status = guide->foresight_status;
  report.guide_horizon_s = std::max(0.0, guide->end_s() - guide_s);
  if (guide->knots > 0) report.guide = guide;
}

void report_scene(const LawInput& input, bool has_target, Report& report) {
  report.tool_position_m = input.poses.tool_position;
  report.tool_velocity_mps = input.tool_jacobian.topRows<3>() * input.velocity_radps;
  if (has_target) report.target_distance_m = (input.target.position_m - input.poses.tool_position).norm();
  if (!input.obstacles.set && input.obstacles.count() == 0) return;
  const Proximity& nearest = input.clearance.nearest;
  report.clearance_m = nearest.distance_m - input.obstacles.possible_m;
  report.nearest_shape = nearest.shape;
  if (nearest.obstacle >= 0) report.nearest_obstacle = input.obstacles.at(nearest.obstacle).id;
}

/// The measured arm; the commanded one while a stream runs and the measured one is too old or contradicts the last one.
ArmState present_arm(const State& state, const InputStatus& status) {
  const bool measured = status.arm_fresh && state.supervision.mode != Mode::kFault;
  if (measured || !state.stream.running) return state.arm_monitor.accepted.state;
  return {state.arm_monitor.accepted.state.utime, state.stream.position_rad, state.stream.velocity_radps};
}

/// Whether the arm may evade without end: in HOLD and TRACK, and in BRAKE while arm and obstacles are known. Otherwise
/// it comes to rest within bounded time.
bool may_evade(const Settings& settings, Mode mode, const InputStatus& status) {
  if (moves(mode)) return true;
  return mode == Mode::kBrake && status.arm_fresh && status.obstacles_fresh && settings.shield.enabled;
}

/// The range of the coming period; `evades`: may_evade().
VelocityRange range_of(const Model& model, Mode mode, bool evades, const ArmState& arm, CommandStream& stream) {
  VelocityRange range = next_range(model, mode, stream, arm);
  if (!evades) return braking_range(model, range, stream);
  stream.braking_s = 0.0;
  return range;
}

/// From the accepted arm state to its command. There is one.
void move_arm(const Model& model, const Inputs& inputs, const MonitorResult& monitored, double now_s, StageProbe& probe,
              Result& result) {
  State& next = result.next;
  const ArmState arm = present_arm(next, monitored.status);
  const OtherFrames others = present_others(model, inputs, now_s);
  const LinkPoses poses = forward_kinematics(model.arm, arm.position_rad, others);
  probe.passed(Stage::kMonitor);

  const ObstacleView obstacles = view_obstacles(model, inputs.obstacles, now_s);
  const ShieldSettings& shield = model.settings.shield;
  const double stopping_s = stopping_time_s(model.arm.limits, arm.velocity_radps) + model.settings.period_s();
  const Reach reach{shield.range_m, shield.pass_horizon_s, shield.person_clearance_m, &arm.velocity_radps, stopping_s};
  const Clearance clearance = measure_clearance(model.arm, poses, obstacles, reach);
  probe.passed(Stage::kClearance);

  const TaskJacobian jacobian = tool_jacobian(poses, target_rows(inputs.target));
  const Target target = inputs.target.message ? present_target(model, jacobian, inputs.target, now_s) : Target{};
  const double period_s = model.settings.period_s();
  const VelocityRange sustainable = sustainable_range(model.arm.limits, arm.position_rad, arm.position_rad, period_s);
  const LawInput input{model.arm, poses,     jacobian,  arm.position_rad, arm.velocity_radps,
                       target,    obstacles, clearance, sustainable};
  const Guide* guide = inputs.guide && inputs.guide->knots > 0 ? inputs.guide : nullptr;
  // Only TRACK is slowed: a retreat in HOLD is not the operator's.
  const double scale = next.supervision.mode == Mode::kTrack ? monitored.speed_scale : 1.0;
  const double guide_s =
      guide ? guide_time_s(model.arm, *guide, arm.position_rad, now_s, period_s, scale * period_s, next.guide_progress)
            : now_s;
  const NominalCommand nominal = scaled(evaluate_law(model, input, next, guide, guide_s), scale);
  probe.passed(Stage::kLaw);

  const Mode& mode = next.supervision.mode;  // latch_not_finite() may still change it
  const bool evades = may_evade(model.settings, mode, monitored.status);
  const VelocityRange range = range_of(model, mode, evades, arm, next.stream);
  // An arm that is asked to stop comes to rest also where an obstacle is nearer than comfort.
  const bool keeps_comfort = evades && !monitored.status.stop;
  const double comfort = keeps_comfort ? comfort_weight(model.settings.shield, input, mode, guide != nullptr) : 0.0;
  const bool is_retreating = guide && guide->is_retreat() && guide_s < guide->end_s();
  const double separation = person_weight(model.settings.shield, mode, is_retreating);
  const JointVector safe_radps =
      apply_shield(model, input, range, nominal.velocity_radps, comfort, separation, next, result.report);
  probe.passed(Stage::kShield);

  if (!safe_radps.allFinite()) latch_not_finite(now_s, next);
  result.command = gate(model, mode, arm, range, safe_radps, next.stream, result.report.limiting);
  next.stream.running = stream_continues(next.stream, mode, monitored);
  next.planned = {mode == Mode::kTrack, nominal.tool_velocity_mps};
  probe.passed(Stage::kGate);

  report_nominal(nominal, safe_radps, result.report);
  report_guide(mode, inputs.guide, guide_s, result.report);
  report_scene(input, inputs.target.message != nullptr, result.report);
}

struct NoProbe : StageProbe {
  void passed(Stage) override {}
};

}  // namespace

Result step(const Model& model, const State& state, const Inputs& inputs, double now_s, StageProbe* probe) {
  Result result;
  State& next = result.next = state;
  const MonitorResult monitored = monitor_inputs(model, inputs, now_s, next.arm_monitor);
  next.supervision = next_mode(state.supervision, monitored.status);
  check_continuity(model, monitored, next.stream);
  const bool was_running = next.stream.running;
  if (monitored.status.arm_known) {
    if (!was_running) {
      start_stream(model, next.arm_monitor.accepted.state, next.arm_monitor.rate_radps, next.stream);
      next.planned.valid = false;
    }
    NoProbe none;
    move_arm(model, inputs, monitored, now_s, probe ? *probe : none, result);
  }
  Report& report = result.report;
  if (inputs.skipped_cycles > 0) report.limiting |= kLimitingLate;
  report.mode = next.supervision.mode;
  report.fault = next.supervision.fault;
  report.message = next.supervision.message;
  report.speed_scale = monitored.speed_scale;
  // The command at rest that ends a stream after a fault is sent as well.
  result.commanding = next.stream.running || (was_running && report.mode == Mode::kFault);
  return result;
}

}  // namespace sidestep
