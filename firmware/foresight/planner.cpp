#include "firmware/foresight/planner.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "firmware/base/bounded_list.h"
#include "firmware/foresight/inverse_kinematics.h"
#include "firmware/foresight/person_proximity.h"
#include "firmware/foresight/rollout.h"
#include "firmware/foresight/self_motion.h"
#include "firmware/foresight/trapezoidal_profile.h"
#include "firmware/model/prediction.h"

namespace sidestep {
namespace {

// All constants are tuned on the witnessed campaign.
constexpr int kTriesPerCall = 6;
constexpr int kSelfMotionTriesPerCall = 40;  // most end before they are checked against obstacles
constexpr int kRetreatTriesPerCall = 100;  // a retreat needs no inverse kinematics and mostly fails at an early sample
constexpr double kSampleEvery_s = 0.06;
constexpr double kLimitShare = 0.9;  // of the velocity and acceleration limits; the rest is left to the shield

// The goal configuration: solve_ik() from a random start, in this share of the tries within so much of the present
// configuration per joint, else anywhere.
constexpr double kNearGoalShare = 0.4;
constexpr double kNearGoal_rad = 0.8;
constexpr double kAnywhere_rad = 2.0 * M_PI;

// The share of the tries that pause before they start, and the longest pause.
constexpr double kPauseShare = 0.25;
constexpr double kLongestPause_s = 2.0;

// The share of the tries with an intermediate configuration, and its range around the present one per joint.
constexpr double kDetourShare = 0.3;
constexpr double kDetour_rad = 1.5;

// The range of a retreat around the present configuration per joint; every other one may lead farther.
constexpr double kRetreat_rad = 1.0;
constexpr double kFarRetreat_rad = 2.0;
constexpr int kTriesFromPersons = 200;  // most are not nearly as far away as the best one so far

// The dampings of self-motions, in turns: the first, the first three or all, by Excursion. So many seconds longer may
// one take that keeps the tool nearer by 0.1 m for 1 s.
constexpr double kDampings[] = {0.01, 0.1, 0.2, 0.4};
constexpr double kAwayCost = 20.0;

// A guide ends so much before the horizon, so that the clearance at its end is known for as long.
constexpr double kStayAtGoal_s = 1.0;

// So much below the clearance at the start, and for so long, a guide may lead on the arm's path out.
constexpr double kStartAllowance_m = 0.005;
constexpr double kStartPhase_s = 0.5;

/// The Forecast::proximity_s of guides from a snapshot, computed at few instants. Large.
class ProximityOfGuides {
 public:
  ProximityOfGuides(const Model& model, const Snapshot& from)
      : arm_(model.arm), now_s_(from.now_s), others_(place_others(model.arm, from.others, from.attachments)) {
    add_persons(from, model.settings.foresight.horizon_s, in_the_end_);
    for (size_t k = 0; k < kInstants; ++k) add_persons(from, after_s(k), at_instants_[k]);
  }

  /// Stops, and returns what it has, once the sum is least_s or more.
  double cost_s(const Guide& guide, double least_s) const {
    double sum_s = kProximityCost_s * proximity(guide.position_rad[guide.knots - 1], in_the_end_);
    for (size_t k = 0; k < kInstants && sum_s < least_s; ++k)
      sum_s += kExposureCost * kEvery_s * proximity(point_of(guide, now_s_ + after_s(k)).position_rad, at_instants_[k]);
    return sum_s;
  }

 private:
  static constexpr size_t kInstants = 8;
  static constexpr double kEvery_s = kExposure_s / kInstants;
  using Persons = BoundedList<Obstacle, kMaxNearbyObstacles>;

  static double after_s(size_t instant) { return (instant + 1) * kEvery_s; }
  static void add_persons(const Snapshot& from, double after_s, Persons& persons) {
    for (int i = 0; i < from.nearby.count; ++i) {
      const Obstacle& obstacle = from.nearby.obstacles[i];
      if (obstacle.kind == Kind::kPerson) persons.add(predicted_obstacle(obstacle, after_s));
    }
  }
  double proximity(const JointVector& q_rad, const Persons& persons) const {
    return person_proximity(forward_kinematics(arm_, q_rad, others_), persons.begin(), persons.size());
  }

  const Arm& arm_;
  const double now_s_;
  const OtherFrames others_;
  Persons in_the_end_;
  std::array<Persons, kInstants> at_instants_;
};

}  // namespace

/// Uniformly distributed within range_rad (times Arm::joint_scale) of a configuration, per joint, and within the
/// position limits, or half a turn of a joint without limits, which may have been wound up.
JointVector Planner::random_configuration(const JointVector& around_rad, double range_rad) {
  const JointLimits& limits = model_.arm.limits;
  JointVector q_rad = around_rad;
  for (Eigen::Index i = 0; i < q_rad.size(); ++i) {
    const double range = range_rad * model_.arm.joint_scale[i];
    q_rad[i] = random_.uniform(std::max(lower_or_half_turn(limits, around_rad, i), q_rad[i] - range),
                               std::min(upper_or_half_turn(limits, around_rad, i), q_rad[i] + range));
  }
  return q_rad;
}

/// A guide with one knot: the present configuration, now.
Guide Planner::start_of(const Snapshot& from, ForesightStatus status) const {
  Guide guide;
  guide.foresight_status = status;
  guide.add(from.now_s, from.arm.position_rad);
  return guide;
}

/// A guide with one knot: the present configuration and velocity, now.
Guide Planner::start_of_retreat(const Snapshot& from) const {
  Guide guide = start_of(from, ForesightStatus::kWaiting);
  guide.velocity_radps[0] =
      stoppable_radps(model_.arm.limits, kLimitShare, from.arm.position_rad, from.arm.velocity_radps);
  return guide;
}

/// From such a start to a random configuration within range_rad.
Guide Planner::random_retreat(const Guide& start, double range_rad) {
  Guide guide = start;
  append_fastest(model_.arm.limits, kLimitShare, random_configuration(start.position_rad[0], range_rad), guide);
  return guide;
}

/// Appends a knot at rest as early as the limits allow. The knot before it must be at rest, too: the largest velocity
/// of the cubic between them is then 1.5 distance / duration, its largest acceleration 6 distance / duration^2.
void Planner::append(Guide& guide, const JointVector& q_rad) const {
  const JointLimits& limits = model_.arm.limits;
  const JointVector distance_rad = (q_rad - guide.position_rad[guide.knots - 1]).cwiseAbs();
  const double by_velocity_s = 1.5 * distance_rad.cwiseQuotient(limits.velocity_radps).maxCoeff();
  const double by_acceleration_s = std::sqrt(6.0 * distance_rad.cwiseQuotient(limits.acceleration_radps2).maxCoeff());
  guide.add(guide.end_s() + std::max(by_velocity_s, by_acceleration_s) / kLimitShare, q_rad);
}

/// Whether the guide, and its last configuration after its end, is clear up to the horizon (see the header).
bool Planner::is_clear(const Snapshot& from, const Guide& guide) const {
  const ForesightSettings& settings = model_.settings.foresight;
  const double enough_m = settings.clearance_m;
  const OtherFrames others = place_others(model_.arm, from.others, from.attachments);
  const auto clearance_at_m = [&](const JointVector& q_rad, double after_s) {
    return clearance_after(model_.arm, forward_kinematics(model_.arm, q_rad, others), from.nearby.obstacles.data(),
                           from.nearby.count, after_s, enough_m, nullptr, true);
  };
  const bool retreats = guide.is_retreat();
  const double at_start_m =
      retreats ? 0.0 : std::min(enough_m, clearance_at_m(guide.position_rad[0], 0.0) - kStartAllowance_m);
  double after_s = 0.0;
  while (after_s <= settings.horizon_s) {
    const double clear_m = clearance_at_m(point_of(guide, from.now_s + after_s).position_rad, after_s);
    if (clear_m < (after_s < kStartPhase_s ? at_start_m : enough_m)) return false;
    after_s += kSampleEvery_s;
  }
  return true;
}

bool Planner::find_goal(const Snapshot& from, const Target& target, JointVector& goal_rad) {
  goal_rad = target.posture_rad;
  if (target.is_posture()) return true;
  const bool near = random_.uniform(0.0, 1.0) < kNearGoalShare;
  goal_rad = random_configuration(from.arm.position_rad, near ? kNearGoal_rad : kAnywhere_rad);
  return solve_ik(model_.arm, target, goal_rad);
}

bool Planner::ends_in_time(const Snapshot& from, const Guide& guide) const {
  return guide.end_s() <= from.now_s + model_.settings.foresight.horizon_s - kStayAtGoal_s;
}

/// Replaces the best guide so far by one that ends before it, in time, and is clear.
void Planner::take_if_sooner(const Snapshot& from, const Guide& guide, Guide& best) const {
  if (!ends_in_time(from, guide)) return;
  if (best.knots > 0 && guide.end_s() >= best.end_s()) return;
  if (is_clear(from, guide)) best = guide;
}

Guide Planner::plan_to_target(const Snapshot& from) {
  const Target target = predicted_target(from.target, kTargetCoast_s);
  found_goal_ = false;
  Guide best;
  for (int attempt = 0; attempt < kTriesPerCall; ++attempt) {
    JointVector goal_rad;
    if (!find_goal(from, target, goal_rad)) continue;
    found_goal_ = true;

    Guide guide = start_of(from, ForesightStatus::kGuided);
    if (random_.uniform(0.0, 1.0) < kPauseShare) guide.time_s[0] += random_.uniform(0.0, kLongestPause_s);
    if (random_.uniform(0.0, 1.0) < kDetourShare)
      append(guide, random_configuration(from.arm.position_rad, kDetour_rad));
    append(guide, goal_rad);
    take_if_sooner(from, guide, best);
  }
  return best;
}

/// The duration of the guide, and kAwayCost times the time that the tool is away from the target at rest.
double Planner::cost_of_self_motion_s(const Snapshot& from, const Guide& guide) const {
  double cost_s = guide.end_s() - from.now_s, at_s = from.now_s;
  while (at_s < guide.end_s()) {
    const LinkPoses poses = forward_kinematics(model_.arm, point_of(guide, at_s).position_rad);
    cost_s += kAwayCost * kSampleEvery_s * distance_share(poses, from.target);
    at_s += kSampleEvery_s;
  }
  return cost_s;
}

Guide Planner::plan_self_motion(const Snapshot& from, Excursion excursion) {
  Target place = from.target;
  place.tracks_orientation = false;
  found_goal_ = false;
  Guide best;
  double least_s = std::numeric_limits<double>::infinity();
  for (int attempt = 0; attempt < kSelfMotionTriesPerCall; ++attempt) {
    const double damping = kDampings[attempt % static_cast<int>(excursion)];
    SelfMotion motion(model_.arm, from.arm.position_rad, place.position_m, damping);
    JointVector goal_rad;
    const bool detours = random_.uniform(0.0, 1.0) < kDetourShare;
    if (detours && !(find_goal(from, place, goal_rad) && motion.reach(goal_rad))) continue;
    if (!find_goal(from, from.target, goal_rad)) continue;
    found_goal_ = true;
    if (!motion.reach(goal_rad)) continue;
    const Guide guide = motion.guide(from.now_s, kLimitShare);
    if (!ends_in_time(from, guide)) continue;
    const double cost_s = cost_of_self_motion_s(from, guide);
    if (cost_s >= least_s || !is_clear(from, guide)) continue;
    best = guide;
    least_s = cost_s;
  }
  return best;
}

Guide Planner::plan_retreat(const Snapshot& from) {
  const Guide start = start_of_retreat(from);
  for (int attempt = 0; attempt < kRetreatTriesPerCall; ++attempt) {
    Guide guide = random_retreat(start, attempt % 2 == 0 ? kRetreat_rad : kFarRetreat_rad);
    if (is_clear(from, guide)) return guide;
  }
  return {};
}

Guide Planner::plan_retreat_from_persons(const Snapshot& from) {
  constexpr std::array<double, 3> kRanges_rad{kRetreat_rad, kFarRetreat_rad, kAnywhere_rad};
  const ProximityOfGuides proximity(model_, from);
  const Guide start = start_of_retreat(from);
  double least_s = proximity.cost_s(start, std::numeric_limits<double>::infinity());  // of the arm that stays
  Guide best;
  for (size_t attempt = 0; attempt < kTriesFromPersons; ++attempt) {
    const Guide guide = random_retreat(start, kRanges_rad[attempt % kRanges_rad.size()]);
    if (!ends_in_time(from, guide)) continue;
    const double cost_s = proximity.cost_s(guide, least_s);
    if (cost_s >= least_s || !is_clear(from, guide)) continue;
    least_s = cost_s;
    best = guide;
  }
  return best;
}

}  // namespace sidestep
