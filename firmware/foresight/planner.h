#pragma once

#include "firmware/base/split_mix64.h"
#include "firmware/foresight/snapshot.h"

namespace sidestep {

/// How far the tool may leave its place in a self-motion: not at all, some centimetres, or farther. The value is the
/// number of dampings that are tried.
enum class Excursion { kNone = 1, kNear = 3, kFar = 4 };

/// Searches for guides by random sampling: joint paths in time that keep clear of the obstacles at their present
/// velocities, persons as predicted_obstacle().
///
/// A guide leads from the present configuration to a goal configuration, possibly after a pause, and possibly through
/// one intermediate configuration, as fast as 90 % of the velocity and acceleration limits allow. In a retreat each
/// joint moves by a trapezoidal profile of its own from the velocity that it has (trapezoidal_profile.h). Every other
/// guide starts with zero velocity, although the arm may be moving, and its joints move on cubics (types/guide.h) that
/// begin and end together. A guide is clear if the clearance of its configurations, sampled every 60 ms up to
/// foresight.horizon_s, is at least foresight.clearance_m. In the first 0.5 s the limit is
/// min(foresight.clearance_m, clearance at the start - 5 mm), and 0 for a retreat: it may start while an obstacle
/// passes, which the shield evades.
class Planner {
 public:
  explicit Planner(const Model& model) : model_(model), random_(model.settings.foresight.seed) {}

  /// Restarts the random sequence from foresight.seed.
  void reset() { random_ = SplitMix64(model_.settings.foresight.seed); }

  /// Six tries. The goal configuration is the target's posture, or has the tool where the target is predicted to be
  /// kTargetCoast_s from now. The guide reaches it at least 1 s before the horizon. Returns the clear guide that
  /// arrives soonest, with ForesightStatus::kGuided; without knots if no try succeeds.
  Guide plan_to_target(const Snapshot& from);

  /// For a target at rest that has the tool in place, or nearly so: the same in 40 tries, with guides along which the
  /// tool stays there (self_motion.h), as far as `excursion` says, and in 30 % of the tries by way of another
  /// configuration that has the tool there. Returns the clear one with the least sum of its duration and 20 times the
  /// time that the tool is away, which counts in full from 0.1 m on.
  Guide plan_self_motion(const Snapshot& from, Excursion excursion);

  /// Whether the last plan_to_target() or plan_self_motion() found a goal configuration, clear or not.
  bool found_goal() const { return found_goal_; }

  /// 100 tries. The goal configuration is random, each joint within 1 rad (0.25 m), in every other try within 2 rad, of
  /// its present position. Returns the first guide that is clear up to the horizon, with ForesightStatus::kWaiting;
  /// without knots if no try succeeds.
  Guide plan_retreat(const Snapshot& from);

  /// 200 tries. The goal configuration is random, each joint within 1 rad, within 2 rad, or anywhere, in turns. Returns
  /// the guide with the least Forecast::proximity_s, computed at 8 instants of the first 3 s and in the end, among
  /// those that are clear and have less than the arm that stays; with ForesightStatus::kWaiting, without knots if no
  /// try succeeds. It ends at least 1 s before the horizon.
  Guide plan_retreat_from_persons(const Snapshot& from);

 private:
  Guide start_of(const Snapshot& from, ForesightStatus status) const;
  Guide start_of_retreat(const Snapshot& from) const;
  Guide random_retreat(const Guide& start, double range_rad);
  JointVector random_configuration(const JointVector& around_rad, double range_rad);
  bool find_goal(const Snapshot& from, const Target& target, JointVector& goal_rad);
  bool is_clear(const Snapshot& from, const Guide& guide) const;
  bool ends_in_time(const Snapshot& from, const Guide& guide) const;
  void take_if_sooner(const Snapshot& from, const Guide& guide, Guide& best) const;
  double cost_of_self_motion_s(const Snapshot& from, const Guide& guide) const;
  void append(Guide& guide, const JointVector& q_rad) const;

  const Model& model_;
  SplitMix64 random_;
  bool found_goal_ = false;
};

}  // namespace sidestep
