#pragma once

#include "firmware/foresight/expectation.h"
#include "firmware/foresight/goal_search.h"
#include "firmware/foresight/planner.h"
#include "firmware/foresight/rollout.h"
#include "firmware/foresight/tree_planner.h"

namespace sidestep {

/// Detects by rollouts that the law would not arrive at the target or would collide, and searches for a guide that
/// arrives. In HOLD, without a target, it detects that the arm at rest would collide, and searches for a retreat.
/// Large: lives on the heap.
class Foresight {
 public:
  explicit Foresight(const Model& model)
      : model_(model),
        rollout_(model),
        planner_(model),
        tree_planner_(model),
        goal_(model.arm),
        expectation_(model.arm) {}

  /// One call per snapshot; returns the guide for the following cycles. Bounded work: at most two rollouts, or two
  /// plans. A forecast is good if the arm arrives, does not collide and is away from the target for less than 4 s;
  /// while the target is a moving pose, if the arm does not collide before the target is assumed to stop.
  ///
  /// Every fifth call is an assessment, unless the last forecast is good and the snapshot is as expected then
  /// (expectation.h). It runs a rollout with the present guide and one without a guide. The guide is dropped if the
  /// rollout without it costs at least 0.5 s less, or if the arm does not arrive with it and the rollout without it
  /// costs no more. A retreat is dropped only after 10 assessments in a row in which the rollout without it does not
  /// collide and costs no more: forecasts of a narrow escape alternate.
  ///
  /// The four calls between two assessments do nothing while the last forecast is good and 20 such calls have passed
  /// since one was not. Otherwise they search in turns: one call plans a candidate with plan_to_target(), or, if that
  /// fails and a collision is predicted, with plan_retreat(). The next call runs a rollout with the candidate and one
  /// with the present guide (or the law alone), which counts as a collision where the forecast before collided. A
  /// candidate that costs at least 0.5 s less becomes the guide. After one to a posture that neither arrives nor
  /// collides only the tree planner plans, once: the paths of plan_to_target() may lead links into each other, which
  /// the shield refuses, and to a posture they are all nearly the same.
  ///
  /// While the tool is within 0.1 m of a target at rest and no collision is predicted for the next 3 s, the first 60
  /// searches since the guide was last changed or a forecast was good plan with plan_self_motion() alone, 10 with
  /// Excursion::kNone, 40 with kNear, 10 with kFar: the arm changes its configuration, and the tool stays at the target
  /// as far as possible. Nor is anything faster looked for.
  ///
  /// The cost of a forecast includes the nearness of persons where the arm ends, which does not count for whether it is
  /// good. While a good forecast is missing because persons keep the arm from its target, every other search plans with
  /// plan_retreat_from_persons() first.
  ///
  /// The status becomes kWaiting, without knots, when three conditions hold: plan_to_target() has failed more than 50
  /// times since the guide was last changed or assessed as good; there is no present guide; the last forecast does not
  /// arrive. The law alone then continues.
  ///
  /// A good forecast is improved where the target and all obstacles rest: 20 calls for each goal, other than
  /// assessments, have the tree planner look for a guide that moves the tool no faster than sidestep.v_max and arrives
  /// 0.15 s earlier, and run the same two rollouts, after which the candidate becomes the guide if it costs 0.15 s
  /// less.
  ///
  /// Guide::goal is what the searches found about the present goal (goal_search.h). No path to a posture is planned
  /// while it is blocked.
  ///
  /// In HOLD a forecast is good if the arm does not collide. Only plan_retreat() is called, and the guide is dropped
  /// after its end as soon as the rollout without it does not collide.
  ///
  /// A snapshot of another mode than HOLD and TRACK, and a change between these two, resets everything. The same
  /// sequence of snapshots gives the same guides.
  const Guide& update(const Snapshot& now);

 private:
  void reset(bool tracking);
  void assess(const Snapshot& now);
  void search(const Snapshot& now);
  void search_faster(const Snapshot& now);
  void evaluate_candidate(const Snapshot& now, double worth_s);
  bool prefers_self_motion(const Snapshot& now) const;
  bool waits_for_persons(const Snapshot& now) const;
  Guide plan_to_goal(const Snapshot& now);
  void adopt(const Guide& guide, const Forecast& forecast);

  const Model& model_;
  Rollout rollout_;
  Planner planner_;
  TreePlanner tree_planner_;
  GoalSearch goal_;
  bool tracking_ = false;  ///< of the last snapshot
  int64_t calls_ = 0;
  int searches_left_ = 0;  ///< after a forecast that was not good
  int faster_left_ = 0;    ///< calls that improve a good forecast for the present goal
  Guide guide_;
  Forecast expected_;             ///< under guide_
  Expectation expectation_;       ///< of expected_
  Guide candidate_;               ///< a plan that has no rollout yet; no knots: none
  bool candidate_stuck_ = false;  ///< the arm would not reach the posture by the last candidate, though it hits nothing
  bool planned_retreat_from_persons_ = false;  ///< in the last search near persons
  int direct_in_a_row_ = 0;        ///< assessments since guide_ was adopted in which the law alone was safe (update())
  int self_motions_left_ = 0;      ///< searches for a self-motion alone, for the present guide or the law alone
  int unsuccessful_searches_ = 0;  ///< failures of plan_to_target() since the guide was changed or assessed as good
};

}  // namespace sidestep
