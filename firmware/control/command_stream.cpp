#include "firmware/control/command_stream.h"

#include <algorithm>

namespace sidestep {
namespace {

constexpr double kRounding_rad = 1e-9;
constexpr double kLeastBraking = 0.5;  // share of the acceleration limit; with 0.2 tests/loop/braking touches more
constexpr double kEvades_s = 0.5;      // before the bound falls; with 0 or 0.3 tests/loop/braking touches more

/// The value of smaller magnitude, or 0 where the signs differ.
double minmod(double a, double b) {
  if (a * b <= 0.0) return 0.0;
  return std::abs(a) < std::abs(b) ? a : b;
}

/// The tolerated following error of a joint, rad; for a prismatic joint m.
double following_error(const Model& model, int joint) {
  return model.settings.following_error_rad * model.arm.joint_scale[joint];
}

/// Part of a joint's following error that the command has to close, rad: the error beyond half the tolerance, so that a
/// command that can catch up is never held back by the tolerance itself; the whole error beyond the tolerance.
double error_to_close_rad(const Model& model, const CommandStream& stream, const ArmState& arm, int joint) {
  const double tolerance_rad = following_error(model, joint), granted_rad = 0.5 * tolerance_rad;
  const double error_rad = arm.position_rad[joint] - stream.position_rad[joint];
  if (std::abs(error_rad) > tolerance_rad) return error_rad;
  return error_rad - std::clamp(error_rad, -granted_rad, granted_rad);
}

/// Rate of a joint's commanded position, rad/s: the commanded velocity, plus the correction that closes a large
/// following error. Within the joint's acceleration limit, which has precedence, its velocity limit and the speed from
/// which it can stop before its position limits.
double commanded_rate(const Model& model, Mode mode, const CommandStream& stream, const ArmState& arm, int joint,
                      double velocity_radps) {
  const double gap_rad = moves(mode) ? error_to_close_rad(model, stream, arm, joint) : 0.0;
  const double last_radps = stream.rate_radps[joint];
  if (gap_rad == 0.0 && last_radps == stream.velocity_radps[joint]) return velocity_radps;
  const double period_s = model.settings.period_s(), acceleration_radps2 = model.arm.limits.acceleration_radps2[joint];
  const double fastest_radps = model.arm.limits.velocity_radps[joint], change_radps = acceleration_radps2 * period_s;
  const auto stopping_radps = [&](double distance_rad) {
    return std::clamp(stopping_velocity(distance_rad, acceleration_radps2, period_s), -fastest_radps, fastest_radps);
  };
  const double lowest_radps = stopping_radps(model.arm.limits.lower_rad[joint] - stream.position_rad[joint]);
  const double highest_radps = stopping_radps(model.arm.limits.upper_rad[joint] - stream.position_rad[joint]);
  const double closer_radps = velocity_radps + stopping_velocity(gap_rad, acceleration_radps2, period_s);
  return std::clamp(std::clamp(closer_radps, lowest_radps, highest_radps), last_radps - change_radps,
                    last_radps + change_radps);
}

/// The commanded position one period later.
JointVector integrate(const Model& model, const CommandStream& stream) {
  const JointLimits& limits = model.arm.limits;
  JointVector position_rad = stream.position_rad + stream.rate_radps * model.settings.period_s();
  for (int i = 0; i < model.arm.joints; ++i) {
    // Removes rounding only. A joint that overshoots is brought back by its velocity, not in one step.
    const double within_rad = std::clamp(position_rad[i], limits.lower_rad[i], limits.upper_rad[i]);
    if (std::abs(position_rad[i] - within_rad) < kRounding_rad) position_rad[i] = within_rad;
  }
  return position_rad;
}

}  // namespace

bool CommandStream::at_rest() const {
  return !running || (velocity_radps.isZero(0.0) && rate_radps.isZero(0.0));
}

void check_continuity(const Model& model, const MonitorResult& inputs, CommandStream& stream) {
  const ArmContinuity& continuity = inputs.continuity;
  if (continuity.clock_went_back) stream.stopped_s = -HUGE_VAL;
  if (stream.running && continuity.cycles_paused) {
    stream.running = false;
    stream.stopped_s = continuity.arm_waited_until_s + model.settings.period_s();  // resolution of the arm states
  }
  stream.running = stream.running && continuity.arm_follows && !inputs.status.arm_starting;
}

void start_stream(const Model& model, const ArmState& arm, const JointVector& arm_rate_radps, CommandStream& stream) {
  const JointVector& fastest = model.arm.limits.velocity_radps;
  stream.position_rad = arm.held_rad.size() > 0 ? arm.held_rad : arm.position_rad;
  stream.velocity_radps = arm.velocity_radps.binaryExpr(arm_rate_radps, &minmod);
  stream.velocity_radps = stream.velocity_radps.cwiseMax(-fastest).cwiseMin(fastest);
  stream.rate_radps = stream.velocity_radps;
}

VelocityRange next_range(const Model& model, Mode mode, const CommandStream& stream, const ArmState& arm) {
  const double period_s = model.settings.period_s();
  JointLimits limits = model.arm.limits;
  JointVector position_rad = stream.position_rad;
  for (int i = 0; i < model.arm.joints; ++i) {
    const double velocity_radps = stream.velocity_radps[i];
    position_rad[i] += (commanded_rate(model, mode, stream, arm, i, velocity_radps) - velocity_radps) * period_s;
    // The command stays within the following error of the arm: an arm that is held in place stops it.
    const double behind_rad = arm.position_rad[i] - following_error(model, i);
    const double ahead_rad = arm.position_rad[i] + following_error(model, i);
    limits.lower_rad[i] = std::max(limits.lower_rad[i], std::min(behind_rad, position_rad[i]));
    limits.upper_rad[i] = std::min(limits.upper_rad[i], std::max(ahead_rad, position_rad[i]));
  }
  return velocity_range(limits, position_rad.cwiseMin(arm.position_rad), position_rad.cwiseMax(arm.position_rad),
                        stream.velocity_radps, period_s);
}

VelocityRange braking_range(const Model& model, const VelocityRange& range, CommandStream& stream) {
  const double period_s = model.settings.period_s();
  const JointLimits& limits = model.arm.limits;
  stream.braking_s += period_s;
  const double falls_s = std::max(0.0, stream.braking_s - kEvades_s);
  const JointVector bound_radps =
      (limits.velocity_radps - kLeastBraking * falls_s * limits.acceleration_radps2).cwiseMax(0.0);
  const JointVector fastest = brake(limits, stream.velocity_radps, period_s);
  return {fastest.cwiseMin(range.lower_radps.cwiseMax(-bound_radps)),
          fastest.cwiseMax(range.upper_radps.cwiseMin(bound_radps))};
}

Command gate(const Model& model, Mode mode, const ArmState& arm, const VelocityRange& range, JointVector velocity_radps,
             CommandStream& stream, int& limiting) {
  const double period_s = model.settings.period_s();
  if (velocity_radps.allFinite())
    limiting |= apply_limits(model.arm.limits, range, stream.velocity_radps, period_s, velocity_radps);
  else
    velocity_radps = brake(model.arm.limits, stream.velocity_radps, period_s);
  for (int i = 0; i < model.arm.joints; ++i)
    stream.rate_radps[i] = commanded_rate(model, mode, stream, arm, i, velocity_radps[i]);
  stream.position_rad = integrate(model, stream);
  stream.velocity_radps = velocity_radps;
  return {stream.position_rad, velocity_radps};
}

bool stream_continues(const CommandStream& stream, Mode mode, const MonitorResult& inputs) {
  if (inputs.status.arm_starting || mode == Mode::kWait) return false;
  const bool arm_answers = inputs.status.arm_fresh && inputs.continuity.arm_received_s > stream.stopped_s;
  if (!stream.running && !arm_answers) return false;
  return mode != Mode::kFault || !stream.at_rest();
}

int apply_limits(const JointLimits& limits, const VelocityRange& range, const JointVector& last_velocity_radps,
                 double period_s, JointVector& velocity_radps) {
  int limiting = kLimitingNothing;
  const double excess = velocity_radps.cwiseAbs().cwiseQuotient(limits.velocity_radps).maxCoeff();
  if (excess > 1.0) {
    velocity_radps /= excess;
    limiting |= kLimitingVelocity;
  }
  for (Eigen::Index i = 0; i < velocity_radps.size(); ++i) {
    const double allowed = std::clamp(velocity_radps[i], range.lower_radps[i], range.upper_radps[i]);
    const double rounding_radps = 1e-12;
    if (std::abs(allowed - velocity_radps[i]) < rounding_radps) continue;
    const double change = std::abs(velocity_radps[i] - last_velocity_radps[i]);
    limiting |= change > limits.acceleration_radps2[i] * period_s ? kLimitingAcceleration : kLimitingPosition;
    velocity_radps[i] = allowed;
  }
  return limiting;
}

JointVector brake(const JointLimits& limits, const JointVector& last_velocity_radps, double period_s) {
  const JointVector step = limits.acceleration_radps2 * period_s;
  return last_velocity_radps - last_velocity_radps.cwiseMax(-step).cwiseMin(step);
}

}  // namespace sidestep
