#pragma once

#include <limits>

namespace sidestep::campaign {

/// What the judge saw in one trial. NaN where it does not apply.
struct Outcome {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  double obstacles = 0.0;
  double duration_s = 0.0;
  double clearance_m = std::numeric_limits<double>::infinity();  ///< least, surface to surface
  double final_error_m = kNone;                                  ///< of the tool
  double arrival_s = kNone;                                      ///< from then on the tool error stays below kArrived_m
  double witness_arrival_s = kNone;                              ///< likewise of the witness
  double path_rad = 0.0;                                         ///< length of the way in joint space, Euclidean
  double witness_path_rad = kNone;
  double error_rms_m = kNone;  ///< chase: once caught; dodge: during the pass
  double error_max_m = kNone;
  double on_target_share = kNone;      ///< chase: of the time once caught, with an error below kArrived_m
  double turn_rms_rad = kNone;         ///< likewise, of the tool's orientation; not of a mere position
  double limit_margin_rad = kNone;     ///< least of a joint to a position limit; negative beyond one
  double speed_radps = kNone;          ///< largest of a joint, of the commands
  double acceleration_radps2 = kNone;  ///< likewise
  double jerk_radps3 = kNone;          ///< likewise
  double chatter_per_s = kNone;        ///< sign changes of a joint's acceleration near an obstacle
  double cpu_mean_s = kNone;           ///< of one cycle
  double cpu_worst_s = kNone;
};

}  // namespace sidestep::campaign
