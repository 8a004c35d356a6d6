#include "firmware/foresight/rollout.h"

#include <algorithm>

#include "firmware/control/extrapolation.h"

#include "firmware/model/prediction.h"

namespace sidestep {
namespace {

// A coarse period bounds the work of one rollout. The period and the costs are tuned on the witnessed campaign.
constexpr double kPeriod_s = 0.03;

constexpr double kArrived_m = 0.01;
constexpr double kArrived_rad = 0.05;

constexpr double kNoArrivalCost_s = 5.0;
constexpr double kCollisionCost_s = 20.0;

// A rollout is coarse: below this clearance a contact is assumed possible.
constexpr double kCollisionClearance_m = 0.01;

void advance(ObstacleSet& set, double dt_s) {
  for (int i = 0; i < set.count; ++i) set.obstacles[i] = extrapolated(set.obstacles[i], dt_s);
}

}  // namespace

Target predicted_target(const Target& target, double after_s) {
  Target then = extrapolated(target, std::min(after_s, kTargetCoast_s));
  if (after_s < kTargetCoast_s) return then;
  then.velocity_mps.setZero();
  then.angular_velocity_radps.setZero();
  return then;
}

bool is_at(const LinkPoses& poses, const Target& target) {
  if ((target.position_m - poses.tool_position).norm() > kArrived_m) return false;
  if (!target.tracks_orientation) return true;
  return Quaternion(poses.tool_rotation).angularDistance(target.orientation) <= kArrived_rad;
}

Rollout::Rollout(const Model& model) : coarse_(model) {
  coarse_.settings.rate_hz = std::min(coarse_.settings.rate_hz, 1.0 / kPeriod_s);
  coarse_.settings.bridges_outliers = false;  // a lag beyond reach between measured and commanded arm is a jump
  coarse_.settings.obstacle_trust = {};       // a snapshot's obstacles are grown already and contain the static ones
  coarse_.surroundings.clear();
}

Forecast Rollout::run(const Snapshot& from, const Guide& guide) {
  const double period_s = coarse_.settings.period_s();
  const int cycles = static_cast<int>(coarse_.settings.foresight.horizon_s / period_s);
  obstacles_.count = from.nearby.count;
  std::copy_n(from.nearby.obstacles.begin(), from.nearby.count, obstacles_.obstacles.begin());
  State state = from.state;
  ArmState arm = from.arm;
  // step() uses only differences of utime.
  arm.utime = state.arm_monitor.accepted.state.utime = state.arm_monitor.before.state.utime = 0;
  Forecast forecast;
  double least_m = std::numeric_limits<double>::infinity();
  for (int cycle = 1; cycle <= cycles; ++cycle) {
    const double after_s = cycle * period_s, now_s = from.now_s + after_s;
    const Target target = predicted_target(from.target, after_s);
    advance(obstacles_, period_s);
    arm.utime += static_cast<int64_t>(period_s * 1e6);
    const int64_t count = state.arm_monitor.count + 1;
    Inputs inputs{{&arm, now_s, count}, {&target, now_s, count}, {&obstacles_, now_s, count}};
    inputs.guide = &guide;
    const Result result = step(coarse_, state, inputs, now_s);
    state = result.next;
    arm.position_rad = result.command.position_rad;
    arm.velocity_radps = result.command.velocity_radps;

    const LinkPoses poses = forward_kinematics(coarse_.arm, arm.position_rad);
    forecast.arrives = is_at(poses, target);
    if (!forecast.arrives) forecast.cost_s += period_s;
    least_m = std::min(least_m, clearance_after(coarse_.arm, poses, obstacles_.obstacles.data(), obstacles_.count,
                                                period_s, kCollisionClearance_m));
  }
  forecast.collides = least_m < kCollisionClearance_m;
  if (!forecast.arrives) forecast.cost_s += kNoArrivalCost_s;
  if (forecast.collides) forecast.cost_s += kCollisionCost_s;
  return forecast;
}

}  // namespace sidestep
