#pragma once

#include <limits>

namespace sidestep::campaign {

/// What the judge measured in one trial. NaN where a value does not apply.
struct TrialMetrics {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  double obstacles = 0.0;
  double duration_s = 0.0;
  double clearance_m = std::numeric_limits<double>::infinity();  ///< least, surface to surface
  double final_error_m = kNone;                                  ///< tool to target at the end
  double arrival_s = kNone;          ///< from this time on the tool error stays below kArrived_m
  double witness_arrival_s = kNone;  ///< the same for the witness
  double path_rad = 0.0;             ///< length of the path in joint space, Euclidean
  double witness_path_rad = kNone;
  double error_rms_m = kNone;          ///< tool error; chase: after the first arrival; dodge: during the pass
  double error_max_m = kNone;          ///< over the same time
  double on_target_share = kNone;      ///< chase: share of the same time with a tool error below kArrived_m
  double turn_rms_rad = kNone;         ///< orientation error of the tool over the same time; only full pose and dodge
  double limit_margin_rad = kNone;     ///< least distance of a joint to a position limit; negative beyond the limit
  double speed_radps = kNone;          ///< largest of any joint in the commands
  double acceleration_radps2 = kNone;  ///< largest of any joint in the commands
  double jerk_radps3 = kNone;          ///< largest of any joint in the commands
  double chatter_per_s = kNone;        ///< sign changes of a joint's acceleration near an obstacle, per second
  double cpu_mean_s = kNone;           ///< CPU time of one cycle
  double cpu_worst_s = kNone;
  double self_clearance_m = std::numeric_limits<double>::infinity();  ///< least between links, if it is below 0.05 m

  // Only among furniture:
  double final_turn_rad = kNone;          ///< orientation error at the end, if the goal has an orientation
  double mover_clearance_m = kNone;       ///< least clearance to the mover
  double goal_clearance_m = kNone;        ///< of the witness at its goal, to the furniture
  double model_goal_clearance_m = kNone;  ///< the same in the controller's model, which is never larger

  // Only if the goal is a posture:
  double final_posture_rad = kNone;  ///< largest distance of a joint to the goal at the end

  // Only among people:
  double rest_clearance_m = kNone;  ///< least clearance of an arm that stays at the start
  double closing_mps = kNone;       ///< contact: largest speed at which the arm itself made the clearance smaller
  double way_out = kNone;           ///< 1: some motion from the start has no contact; 0: none was found
  double seen_way_out = kNone;      ///< contact: the same from the arm's state when the controller could first see
                                    ///< the approach that ended in it (people_judge.h)
};

}  // namespace sidestep::campaign
