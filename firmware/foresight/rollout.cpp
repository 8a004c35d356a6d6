#include "firmware/foresight/rollout.h"

#include <algorithm>

#include "firmware/control/extrapolation.h"
#include "firmware/control/shield/required_clearance.h"
#include "firmware/foresight/person_proximity.h"
#include "firmware/model/clearance.h"
#include "firmware/model/prediction.h"

namespace sidestep {
namespace {

// At the controller's own period a rollout is what will happen, if the arm is ideal and the obstacles are exact; at
// another one it soon evades otherwise than the arm. A coarse period after that bounds the work of one rollout. The
// periods and the costs are tuned on the witnessed campaign and the adversarial search.
constexpr double kFinePeriod_s = 0.01, kCoarsePeriod_s = 0.03;
constexpr double kFine_s = 0.6;

constexpr double kArrived_m = 0.01;
constexpr double kArrived_rad = 0.05;

// A tool's way of about 10 mm.
constexpr double kInPosture_rad = 0.02;
constexpr double kSamePosture_rad = 0.005;
constexpr double kSamePlace_m = 0.005;
constexpr double kSameOrientation_rad = 0.03;

constexpr double kNoArrivalCost_s = 5.0;

// A tool farther away than kAway_m counts as away in full. An arm that follows a moving pose a little late is not to be
// led elsewhere, and at a pose at rest it had better turn with the tool in place. Tuned on the campaign's follow6d; for
// moving positions (chase) it brought nothing.
constexpr double kAway_m = 0.1;
constexpr double kNotTurned = 0.5;  // what counts at a pose at rest where only the orientation is missing

// A rollout is coarse: below this share of the hard clearance a contact is assumed possible.
constexpr double kCollisionShare = 0.5;

// In HOLD a retreat costs nothing, so an arm that is squeezed, though the rollout has no contact, leaves early.
constexpr double kSqueezedShare = 1.5;

constexpr double kExposureStep_s = 0.1;  // persons and arms move some centimetres meanwhile

constexpr double kRest_radps = 0.005;  // an arm that is slower rests

/// How much the time away from a target counts, 0 to 1; `moves`: it was a moving pose when the rollout began.
double away_share(const LinkPoses& poses, const Target& target, bool moves) {
  if (!target.tracks_orientation) return 1.0;
  const double share = distance_share(poses, target);
  return moves ? share : kNotTurned + (1.0 - kNotTurned) * share;
}

void advance(ObstacleSet& set, double dt_s, double after_s) {
  for (int i = 0; i < set.count; ++i) advance(set.obstacles[i], dt_s, after_s);
}

/// The integral of person_proximity() over the first kExposure_s.
class Exposure {
 public:
  /// The arm at after_s, which was about the same since the last call.
  void add(const LinkPoses& poses, const ObstacleSet& set, double after_s) {
    if (after_s < until_s_ + kExposureStep_s || until_s_ >= kExposure_s) return;
    const double until_s = std::min(after_s, kExposure_s);
    integral_s_ += (until_s - until_s_) * person_proximity(poses, set.obstacles.data(), set.count);
    until_s_ = until_s;
  }
  double integral_s() const { return integral_s_; }

 private:
  double integral_s_ = 0.0, until_s_ = 0.0;
};

}  // namespace

Target predicted_target(const Target& target, double after_s) {
  Target then = extrapolated(target, std::min(after_s, kTargetCoast_s));
  if (after_s < kTargetCoast_s) return then;
  then.velocity_mps.setZero();
  then.angular_velocity_radps.setZero();
  return then;
}

bool is_at_rest(const Target& target) {
  return target.velocity_mps.isZero(0.0) && target.angular_velocity_radps.isZero(0.0);
}

bool is_moving_pose(const Target& target) {
  return target.tracks_orientation && !is_at_rest(target);
}

double distance_share(const LinkPoses& poses, const Target& target) {
  return std::min(1.0, (target.position_m - poses.tool_position).norm() / kAway_m);
}

bool is_at(const LinkPoses& poses, const Target& target) {
  if ((target.position_m - poses.tool_position).norm() > kArrived_m) return false;
  if (!target.tracks_orientation) return true;
  return Quaternion(poses.tool_rotation).angularDistance(target.orientation) <= kArrived_rad;
}

bool is_in_posture(const Arm& arm, const JointVector& q_rad, const Target& target) {
  return max_norm(q_rad - target.posture_rad, arm.joint_scale) <= kInPosture_rad;
}

bool is_same_posture(const Target& a, const Target& b, const JointVector& joint_scale) {
  if (!a.is_posture() || !b.is_posture()) return a.is_posture() == b.is_posture();
  return max_norm(a.posture_rad - b.posture_rad, joint_scale) <= kSamePosture_rad;
}

bool is_same_goal(const Target& a, const Target& b, const JointVector& joint_scale) {
  return is_same_posture(a, b, joint_scale) && a.tracks_orientation == b.tracks_orientation &&
         (a.position_m - b.position_m).norm() <= kSamePlace_m &&
         (!a.tracks_orientation || a.orientation.angularDistance(b.orientation) <= kSameOrientation_rad);
}

Rollout::Rollout(const Model& model)
    : model_(model),
      fine_hz_(std::min(model.settings.rate_hz, 1.0 / kFinePeriod_s)),
      coarse_hz_(std::min(model.settings.rate_hz, 1.0 / kCoarsePeriod_s)) {
  model_.settings.bridges_outliers = false;  // a lag beyond reach between measured and commanded arm is a jump
  model_.settings.timeouts.control_s = 0.0;  // a forecast assumes full speed and no pause
  // A snapshot's obstacles are grown already and contain the static ones.
  ShieldSettings& shield = model_.settings.shield;
  if (!is_exact(model_.settings.obstacle_trust)) shield.rest_clearance_m = shield.hard_clearance_m;
  model_.settings.obstacle_trust = {};
  model_.surroundings.clear();
}

/// Whether the arm rests and nothing in the rest of the horizon would move it: the guide has ended, the target rests
/// and no obstacle within reach comes nearer. Away from the target, an obstacle that leaves may also move it.
bool Rollout::stays_at_rest(const Snapshot& from, const Guide& guide, const LinkPoses& poses, const ArmState& arm,
                            double after_s, bool arrives) const {
  if (max_norm(arm.velocity_radps, model_.arm.joint_scale) > kRest_radps) return false;
  if (guide.knots > 0 && from.now_s + after_s < guide.end_s()) return false;
  if (from.tracking && !is_at_rest(predicted_target(from.target, after_s))) return false;
  const auto *obstacles = obstacles_.obstacles.begin(), *end = obstacles + obstacles_.count;
  if (!arrives) return std::none_of(obstacles, end, is_moving);
  const auto walks_on = [](const Obstacle& obstacle) { return !obstacle.mean_velocity_mps.isZero(0.0); };
  if (after_s <= kPersonCoast_s && std::any_of(obstacles, end, walks_on)) return false;
  const Reach reach{model_.settings.shield.range_m, model_.settings.foresight.horizon_s - after_s};
  const Clearance clearance = measure_clearance(model_.arm, poses, {&obstacles_, 0.0, 0.0, nullptr}, reach);
  const auto comes = [&](const NearPair& pair) {
    const Vector3& turning_radps = obstacles_.obstacles[pair.now.obstacle].angular_velocity_radps;
    return pair.approach.time_s > 0.0 || !turning_radps.isZero(0.0);
  };
  return std::none_of(clearance.near.begin(), clearance.near.end(), comes);
}

Forecast Rollout::run(const Snapshot& from, const Guide& guide) {
  const double horizon_s = model_.settings.foresight.horizon_s;
  obstacles_.count = from.nearby.count;
  std::copy_n(from.nearby.obstacles.begin(), from.nearby.count, obstacles_.obstacles.begin());
  State state = from.state;
  ArmState arm = from.arm;
  const OtherFrames others = place_others(model_.arm, from.others, from.attachments);
  // step() uses only differences of utime.
  arm.utime = state.arm_monitor.accepted.state.utime = state.arm_monitor.before.state.utime = 0;
  Forecast forecast;
  const ShieldSettings& shield = model_.settings.shield;
  const double share = from.tracking ? kCollisionShare : kSqueezedShare, enough_m = share * shield.hard_clearance_m;
  std::array<double, kMaxNearbyObstacles> allowance_m;
  for (int i = 0; i < from.nearby.count; ++i)
    allowance_m[i] =
        share * (shield.hard_clearance_m -
                 required_clearance_m(shield.hard_clearance_m, shield.rest_clearance_m, from.nearby.obstacles[i]));
  forecast.period_s = 1.0 / fine_hz_;
  const bool separates = from.tracking && shield.person_weight > 0.0;
  Exposure exposure;
  double least_m = std::numeric_limits<double>::infinity(), away = 1.0;
  for (double after_s = 0.0; after_s < horizon_s - kCoarsePeriod_s / 2.0;) {
    model_.settings.rate_hz = after_s < kFine_s - kFinePeriod_s / 2.0 ? fine_hz_ : coarse_hz_;
    const double period_s = model_.settings.period_s();
    after_s += period_s;
    const double now_s = from.now_s + after_s;
    const Target target = predicted_target(from.target, after_s);
    advance(obstacles_, period_s, after_s);
    arm.utime += std::llround(period_s * 1e6);
    const int64_t count = state.arm_monitor.count + 1;
    Inputs inputs{{&arm, now_s, count}, {}, {&obstacles_, now_s, count}};
    if (from.tracking) inputs.target = {&target, now_s, count};
    inputs.other_joints = {&from.others, now_s, count};
    inputs.attachments = {&from.attachments, now_s, count};
    inputs.guide = &guide;
    const Result result = step(model_, state, inputs, now_s);
    state = result.next;
    arm.position_rad = result.command.position_rad;
    arm.velocity_radps = result.command.velocity_radps;

    const LinkPoses poses = forward_kinematics(model_.arm, arm.position_rad, others);
    forecast.arrives = !from.tracking || (target.is_posture() ? is_in_posture(model_.arm, arm.position_rad, target)
                                                              : is_at(poses, target));
    away = away_share(poses, target, is_moving_pose(from.target));
    const auto stay_away = [&](double for_s) {
      forecast.away_s += for_s;
      forecast.cost_s += away * for_s;
    };
    if (!forecast.arrives) stay_away(period_s);
    least_m = std::min(least_m, clearance_after(model_.arm, poses, obstacles_.obstacles.data(), obstacles_.count,
                                                period_s, enough_m, allowance_m.data()));
    if (least_m < enough_m && !forecast.collides) forecast.collision_s = after_s;
    forecast.collides = least_m < enough_m;
    if (separates) exposure.add(poses, obstacles_, after_s);
    if (after_s <= kForecastPath_s && !forecast.path_rad.is_full()) forecast.path_rad.add(arm.position_rad);
    if (stays_at_rest(from, guide, poses, arm, after_s, forecast.arrives)) {
      if (!forecast.arrives) stay_away(std::max(0.0, horizon_s - after_s));
      if (separates) exposure.add(poses, obstacles_, horizon_s);
      break;
    }
  }
  if (!forecast.arrives) forecast.cost_s += away * kNoArrivalCost_s;
  if (forecast.collides) forecast.cost_s += kCollisionCost_s;
  if (separates) {
    const LinkPoses poses = forward_kinematics(model_.arm, arm.position_rad, others);
    forecast.proximity_s = kProximityCost_s * person_proximity(poses, obstacles_.obstacles.data(), obstacles_.count) +
                           kExposureCost * exposure.integral_s();
    forecast.cost_s += forecast.proximity_s;
  }
  return forecast;
}

}  // namespace sidestep
