#pragma once

#include <limits>

#include "firmware/base/bounded_list.h"
#include "firmware/foresight/snapshot.h"
#include "firmware/model/kinematics.h"

namespace sidestep {

constexpr double kForecastPath_s = 0.5;  ///< a forecast keeps the arm's path for so long
constexpr int kMaxPathPoints = 64;

constexpr double kCollisionCost_s = 20.0;  ///< more than any delay, so that a collision decides

/// Costs of person_proximity() 1: where a rollout ends, and for each of the first kExposure_s seconds of the way. Tuned
/// on the campaign's two-people@camera.
constexpr double kProximityCost_s = 60.0, kExposureCost = 20.0;
constexpr double kExposure_s = 3.0;

/// The result of a rollout.
struct Forecast {
  bool arrives = false;   ///< the tool is at the target, or the arm in the posture, at the end; always true in HOLD
  bool collides = false;  ///< the clearance falls below half of what is needed (in HOLD below 1.5 times)
  double collision_s = std::numeric_limits<double>::infinity();  ///< time of the first collision after the snapshot
  double away_s = 0.0;                                           ///< time not at the target, in full
  double cost_s = 0.0;  ///< time away from the target, + 5 s if it does not arrive, + kCollisionCost_s if it collides.
                        ///< The first two count in full from 0.1 m on if the target is a pose, less below: nothing
                        ///< at the position of one that moves, half at that of one at rest
  double proximity_s = 0.0;  ///< the further part of cost_s for the nearness of persons, in TRACK: kProximityCost_s
                             ///< person_proximity() at the end + kExposureCost times its integral over the first
                             ///< kExposure_s; 0 if shield.person_weight is 0

  double period_s = 0.0;                              ///< between two points of the path
  BoundedList<JointVector, kMaxPathPoints> path_rad;  ///< one period after the snapshot, and so on
};

/// Simulates the next foresight.horizon_s seconds, in the mode of the snapshot, with the controller's own step() and an
/// ideal arm, which follows each command exactly. The period is 10 ms for 0.6 s and then 30 ms, unless the controller's
/// is longer. Obstacles move as predicted_obstacle(), the target as predicted_target(). A simulation ends early when
/// the arm rests and nothing could move it any more. About 800 kB: lives on the heap.
class Rollout {
 public:
  explicit Rollout(const Model& model);

  /// From a snapshot with moves = true, under a guide (no knots: the law alone). No allocation.
  Forecast run(const Snapshot& from, const Guide& guide);

 private:
  bool stays_at_rest(const Snapshot& from, const Guide& guide, const LinkPoses& poses, const ArmState& arm,
                     double after_s, bool arrives) const;

  Model model_;  ///< its rate is that of the coming step
  double fine_hz_, coarse_hz_;
  ObstacleSet obstacles_;
};

/// For how long a target is assumed to keep its velocity.
constexpr double kTargetCoast_s = 1.0;

/// Whether both targets are of the same kind, and postures agree within 0.005 rad (times joint_scale) per joint: a
/// forecast or plan for one is good for the other, the law bridges the rest.
bool is_same_posture(const Target& a, const Target& b, const JointVector& joint_scale);

/// Whether is_same_posture(), and the targets agree within 5 mm and, where they track orientation, 0.03 rad.
bool is_same_goal(const Target& a, const Target& b, const JointVector& joint_scale);

/// The target after_s later: it keeps its velocity for kTargetCoast_s and then rests.
Target predicted_target(const Target& target, double after_s);

/// Whether the target has no velocity.
bool is_at_rest(const Target& target);

/// Whether the target has an orientation and a velocity.
bool is_moving_pose(const Target& target);

/// How far the tool is from the target's position: 0 there, 1 from 0.1 m on.
double distance_share(const LinkPoses& poses, const Target& target);

/// Whether the tool is within 10 mm of the target and, where the target tracks orientation, within 0.05 rad.
bool is_at(const LinkPoses& poses, const Target& target);

/// Whether every joint of q_rad, n x 1, is within 0.02 rad (times Arm::joint_scale) of the posture of a target.
bool is_in_posture(const Arm& arm, const JointVector& q_rad, const Target& target);

}  // namespace sidestep
