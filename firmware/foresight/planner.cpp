#include "firmware/foresight/planner.h"

#include <algorithm>
#include <cmath>

#include "firmware/foresight/inverse_kinematics.h"
#include "firmware/foresight/rollout.h"
#include "firmware/model/prediction.h"

namespace sidestep {
namespace {

constexpr int kTriesPerCall = 6;
constexpr double kCheckEvery_s = 0.06;
constexpr double kSpeedShare = 0.9;  // of the limits, so that the shield has something left
constexpr double kLongestPause_s = 2.0;

/// Where nothing is known of the range, one turn.
double range(double limit_rad, double otherwise_rad) {
  return std::isfinite(limit_rad) ? limit_rad : otherwise_rad;
}

}  // namespace

double SplitMix64::uniform(double lower, double upper) {
  state_ += 0x9e3779b97f4a7c15ULL;
  uint64_t z = state_;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  z ^= z >> 31;
  return lower + (upper - lower) * static_cast<double>(z >> 11) * 0x1.0p-53;
}

JointVector Planner::random_configuration(const JointVector& around_rad, double reach_rad) {
  const JointLimits& limits = model_.arm.limits;
  JointVector q_rad = around_rad;
  for (Eigen::Index i = 0; i < q_rad.size(); ++i)
    q_rad[i] = random_.uniform(std::max(range(limits.lower_rad[i], -M_PI), q_rad[i] - reach_rad),
                               std::min(range(limits.upper_rad[i], M_PI), q_rad[i] + reach_rad));
  return q_rad;
}

/// Goes on to a posture as fast as the limits allow with the guide's profile: at most 1.5 ways / duration in velocity
/// and 6 ways / duration^2 in acceleration.
void Planner::append(Guide& guide, const JointVector& q_rad) const {
  const JointLimits& limits = model_.arm.limits;
  const JointVector way_rad = (q_rad - guide.position_rad[guide.knots - 1]).cwiseAbs();
  const double by_velocity_s = 1.5 * way_rad.cwiseQuotient(limits.velocity_radps).maxCoeff();
  const double by_acceleration_s = std::sqrt(6.0 * way_rad.cwiseQuotient(limits.acceleration_radps2).maxCoeff());
  guide.time_s[guide.knots] = guide.end_s() + std::max(by_velocity_s, by_acceleration_s) / kSpeedShare;
  guide.position_rad[guide.knots++] = q_rad;
}

/// All along the guide and behind its end, up to the horizon.
bool Planner::is_clear(const Snapshot& from, const Guide& guide) const {
  const ForesightSettings& settings = model_.settings.foresight;
  // What is nearer already may stay so near, but no nearer.
  const double enough_m = settings.clearance_m;
  const LinkPoses at_start = forward_kinematics(model_.arm, guide.position_rad[0]);
  const double start_m =
      clearance_after(model_.arm, at_start, from.nearby.obstacles.data(), from.nearby.count, 0.0, enough_m);
  const double wanted_m = std::min(enough_m, start_m - 0.005);
  for (double after_s = 0.0; after_s <= settings.horizon_s; after_s += kCheckEvery_s) {
    const LinkPoses poses = forward_kinematics(model_.arm, point_of(guide, from.now_s + after_s).position_rad);
    const double clear_m =
        clearance_after(model_.arm, poses, from.nearby.obstacles.data(), from.nearby.count, after_s, enough_m);
    if (clear_m < (after_s < 0.5 ? wanted_m : enough_m)) return false;
  }
  return true;
}

Guide Planner::to_target(const Snapshot& from) {
  const double horizon_s = model_.settings.foresight.horizon_s;
  const Target target = predicted_target(from.target, kTargetBelieved_s);
  Guide best;
  for (int attempt = 0; attempt < kTriesPerCall; ++attempt) {
    const double kind = random_.uniform(0.0, 1.0);
    JointVector goal_rad = random_configuration(from.arm.position_rad, kind < 0.4 ? 0.8 : 2.0 * M_PI);
    if (!solve_ik(model_.arm, target, goal_rad)) continue;

    Guide guide;
    guide.foresight_status = ForesightStatus::kGuided;
    guide.knots = 1;
    guide.time_s[0] = from.now_s;
    guide.position_rad[0] = from.arm.position_rad;
    if (random_.uniform(0.0, 1.0) < 0.25) guide.time_s[0] += random_.uniform(0.0, kLongestPause_s);
    if (random_.uniform(0.0, 1.0) < 0.3) append(guide, random_configuration(from.arm.position_rad, 1.5));
    append(guide, goal_rad);
    if (guide.end_s() > from.now_s + horizon_s - 1.0) continue;
    if (best.knots > 0 && guide.end_s() >= best.end_s()) continue;
    if (is_clear(from, guide)) best = guide;
  }
  return best;
}

Guide Planner::to_safety(const Snapshot& from) {
  for (int attempt = 0; attempt < kTriesPerCall; ++attempt) {
    Guide guide;
    guide.foresight_status = ForesightStatus::kWaiting;
    guide.knots = 1;
    guide.time_s[0] = from.now_s;
    guide.position_rad[0] = from.arm.position_rad;
    append(guide, random_configuration(from.arm.position_rad, 1.0));
    if (is_clear(from, guide)) return guide;
  }
  return {};
}

}  // namespace sidestep
