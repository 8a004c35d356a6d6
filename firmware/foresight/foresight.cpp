#include "firmware/foresight/foresight.h"

#include <algorithm>
#include <cmath>

namespace sidestep {
namespace {

// Tuned on the witnessed campaign, as the cost below which a forecast is good.
constexpr int kAssessEvery_calls = 5;
constexpr double kWorthAChange_s = 0.5;  // of cost; smaller differences are no reason to change the guide
constexpr double kGoodCost_s = 4.0;
constexpr int kSearchesUntilWaiting = 50;
constexpr int kSearchesAfterBad = 20;
constexpr int kTrustedInARow = 10;
constexpr double kNearPersons_s = 0.5;  // of proximity_s: nearer than that the arm looks for a retreat

// So often a search looks for a self-motion alone, while the tool is in place and no collision is near. Few tries find
// one that keeps the tool near its place where none keeps it there, so that most searches are for these.
constexpr int kSelfMotionSearches = 60;
constexpr int kLooseSelfMotionSearches = 50;  // the last ones
constexpr int kFarSelfMotionSearches = 10;    // the last of these
constexpr double kNearCollision_s = 3.0;

// Where everything rests, forecasts are exact enough for a smaller difference. Later than this an arm is well under
// way, and the exchange of guides costs what the new one gains.
constexpr double kClearlyEarlier_s = 0.15;
constexpr int kSearchesForFaster = 20;

bool everything_rests(const Snapshot& now) {
  const auto end = now.nearby.obstacles.begin() + now.nearby.count;
  return now.tracking && is_at_rest(now.target) && std::none_of(now.nearby.obstacles.begin(), end, is_moving);
}

/// Whether a better guide need not be searched. How long a pose will move is unknown, so that the arm is not led away
/// from one that moves, nor for a collision at a place where the tool will only be if the target stops there (measured
/// on the campaign's chase6d and follow6d; not tried for positions).
bool is_good(const Snapshot& now, const Forecast& forecast) {
  if (now.tracking && is_moving_pose(now.target)) return forecast.collision_s > kTargetCoast_s;
  return !forecast.collides && forecast.cost_s - forecast.proximity_s < kGoodCost_s;
}

/// Of the next search, when so many searches for a self-motion are left.
Excursion excursion_of(int searches_left) {
  if (searches_left > kLooseSelfMotionSearches) return Excursion::kNone;
  return searches_left > kFarSelfMotionSearches ? Excursion::kNear : Excursion::kFar;
}

/// Whether the tool is at the position of a target at rest, or nearly so.
bool is_in_place(const Arm& arm, const Snapshot& now) {
  if (!now.tracking || now.target.is_posture() || !is_at_rest(now.target)) return false;
  return distance_share(forward_kinematics(arm, now.arm.position_rad), now.target) < 1.0;
}

}  // namespace

void Foresight::reset(bool tracking) {
  tracking_ = tracking;
  expectation_.clear();
  adopt(Guide{}, Forecast{});
  candidate_ = Guide{};
  planner_.reset();
  tree_planner_.reset();
  calls_ = 0;
  searches_left_ = 0;
  faster_left_ = 0;
  candidate_stuck_ = false;
  planned_retreat_from_persons_ = false;
  goal_.forget_goal();
}

void Foresight::adopt(const Guide& guide, const Forecast& forecast) {
  guide_ = guide;
  expected_ = forecast;
  unsuccessful_searches_ = 0;
  self_motions_left_ = kSelfMotionSearches;
  direct_in_a_row_ = 0;
}

void Foresight::assess(const Snapshot& now) {
  expected_ = rollout_.run(now, guide_);
  if (guide_.knots > 0) {
    const Forecast direct = rollout_.run(now, Guide{});
    const bool is_safe = !direct.collides && direct.cost_s <= expected_.cost_s;
    direct_in_a_row_ = is_safe ? direct_in_a_row_ + 1 : 0;
    const bool is_retreat = guide_.is_retreat();
    const bool is_over = !now.tracking && !direct.collides && now.now_s >= guide_.end_s();
    const bool is_better =
        direct.cost_s < expected_.cost_s - kWorthAChange_s || (!expected_.arrives && direct.cost_s <= expected_.cost_s);
    // A retreat leads out of a danger that forecasts see by turns.
    const bool is_trusted = !is_retreat || direct_in_a_row_ >= kTrustedInARow;
    if (is_over || (is_better && is_trusted)) adopt(Guide{}, direct);
  }
  if (is_good(now, expected_)) {
    unsuccessful_searches_ = 0;
    self_motions_left_ = kSelfMotionSearches;
    candidate_ = Guide{};
    if (guide_.knots == 0) guide_.foresight_status = ForesightStatus::kDirect;
  }
  expectation_.set(now, expected_);
}

/// Whether the arm had better change its configuration with the tool in place than lead the tool away and back.
bool Foresight::prefers_self_motion(const Snapshot& now) const {
  return self_motions_left_ > 0 && expected_.collision_s > kNearCollision_s && is_in_place(model_.arm, now);
}

Guide Foresight::plan_to_goal(const Snapshot& now) {
  const bool blocked = tree_planner_.is_blocked(now);
  goal_.examined(blocked);
  if (blocked) return {};
  if (prefers_self_motion(now)) {
    Guide guide = planner_.plan_self_motion(now, excursion_of(self_motions_left_--));
    goal_.searched(planner_.found_goal());
    return guide;
  }
  Guide guide;
  if (!candidate_stuck_) guide = planner_.plan_to_target(now);
  candidate_stuck_ = false;
  if (guide.knots == 0) guide = tree_planner_.plan(now);
  goal_.searched(planner_.found_goal() || tree_planner_.has_goal(now));
  return guide;
}

/// Both rollouts start from the same snapshot: whether a coarse rollout just touches an obstacle may differ from one
/// snapshot to the next. So the danger is not over because one of two forecasts misses it.
void Foresight::evaluate_candidate(const Snapshot& now, double worth_s) {
  const double collision_s = expected_.collision_s;
  expected_ = rollout_.run(now, guide_);
  if (std::isfinite(collision_s) && !expected_.collides) {
    expected_.collides = true;
    expected_.collision_s = collision_s;
    expected_.cost_s += kCollisionCost_s;
  }
  const Forecast forecast = rollout_.run(now, candidate_);
  const bool is_adopted = forecast.cost_s < expected_.cost_s - worth_s;
  if (is_adopted) adopt(candidate_, forecast);
  candidate_stuck_ = now.target.is_posture() && !is_adopted && !forecast.arrives && !forecast.collides;
  expectation_.set(now, expected_);
  candidate_ = Guide{};
}

void Foresight::search_faster(const Snapshot& now) {
  if (candidate_.knots > 0) return evaluate_candidate(now, kClearlyEarlier_s);
  candidate_ = tree_planner_.plan_under_way(now, model_.settings.sidestep.v_max_mps);
  if (candidate_.end_s() > now.now_s + expected_.away_s - kClearlyEarlier_s) candidate_ = Guide{};
}

/// Whether persons keep the arm from its target.
bool Foresight::waits_for_persons(const Snapshot& now) const {
  return now.tracking && !expected_.arrives && expected_.proximity_s > kNearPersons_s;
}

void Foresight::search(const Snapshot& now) {
  if (candidate_.knots > 0) return evaluate_candidate(now, kWorthAChange_s);
  if (waits_for_persons(now)) {
    planned_retreat_from_persons_ = !planned_retreat_from_persons_;
    if (planned_retreat_from_persons_) candidate_ = planner_.plan_retreat_from_persons(now);
    if (candidate_.knots > 0) return;
  }
  candidate_ = now.tracking ? plan_to_goal(now) : Guide{};
  if (candidate_.knots > 0) return;
  if (expected_.collides && !prefers_self_motion(now)) candidate_ = planner_.plan_retreat(now);
  if (++unsuccessful_searches_ > kSearchesUntilWaiting && guide_.knots == 0 && !expected_.arrives)
    guide_.foresight_status = ForesightStatus::kWaiting;
}

const Guide& Foresight::update(const Snapshot& now) {
  if (!now.moves || now.tracking != tracking_) reset(now.tracking);
  if (!now.moves) return guide_;
  if (now.tracking && goal_.set_goal(now.target)) faster_left_ = kSearchesForFaster;
  // Forecasts may alternate: an arm that waits beside an obstacle seems to get past it in one of two.
  if (calls_ > 0 && !is_good(now, expected_)) searches_left_ = kSearchesAfterBad;
  if (calls_++ % kAssessEvery_calls != 0) {
    if (faster_left_ > 0 && is_good(now, expected_) && everything_rests(now) && !is_in_place(model_.arm, now))
      --faster_left_, search_faster(now);
    else if (searches_left_ > 0)
      --searches_left_, search(now);
  } else if (!is_good(now, expected_) || !expectation_.holds(now)) {
    assess(now);
  }
  if (is_good(now, expected_)) goal_.clear();
  guide_.goal = goal_.finding();
  return guide_;
}

}  // namespace sidestep
