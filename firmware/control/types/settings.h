#pragma once

#include "firmware/model/types.h"

namespace sidestep {

enum class Law { kSidestep, kPaper };
enum class ToolVelocity { kMeasured, kPlanned };

/// Gains of the paper's law; symbols and starting values: docs/paper.md, "Parameters".
struct PaperGains {
  double k_pos_per_s2 = 20.0;
  double k_vel_per_s = 8.94;
  double k_rpos_m2ps2 = 0.5;
  double k_rvel_m2ps2 = 0.1;
  double rho_0_m = 0.25;
  double rho_v_m = 0.25;
  double rho_min_m = 0.02;
  double v_max_mps = 1.0;
  double lambda_0 = 0.08;
  double sigma_0 = 0.08;
  double lambda_n = 0.05;
  double x_m_mps = 0.5;
  double d_m_m = 0.3;
  double d_1_m = 0.3;
  double d_2_m = 0.1;
  double k_ori_per_s = 5.0;
  ToolVelocity tool_velocity = ToolVelocity::kMeasured;
};

/// Gains of our own law, which computes the nominal velocity (sidestep_law.h).
struct SidestepGains {
  double k_pos_per_s = 8.0;          ///< tool speed per metre, or joint speed per radian, of distance to the target
  double k_ori_per_s = 4.0;          ///< angular speed per radian of orientation error, for full-pose targets
  double k_posture_per_s = 0.5;      ///< joint speed away from the position limits, in the null space of the task
  double k_guide_per_s = 4.0;        ///< feedback gain on the deviation from a guide
  double guide_posture_share = 0.5;  ///< largest speed toward the last knot after the guide has ended, in the null
                                     ///< space of the task, as a share of each velocity limit
  double v_max_mps = 1.0;            ///< largest tool speed toward the target, on top of the target's own velocity
  double lambda_0 = 0.05;            ///< largest damping near singular postures, paper eq (6)
  double sigma_0 = 0.05;             ///< damping begins below this singular value
};

/// The shield (shield.h). Distances are from surface to surface.
struct ShieldSettings {
  bool enabled = true;                ///< off for experiments only
  double hard_clearance_m = 0.02;     ///< hard tier: kept as long as the hard rows can be met
  double rest_clearance_m = 0.004;    ///< in place of hard_clearance_m, for what rests and is exactly known
  double hard_gain_per_s = 15.0;      ///< approach speed per metre above hard_clearance_m
  double pass_clearance_m = 0.04;     ///< pass tier: distance at the closest approach of a moving obstacle
  double pass_gain_per_s = 6.0;       ///< approach speed per metre above pass_clearance_m, at the closest approach
  double pass_reaction_s = 0.12;      ///< time the arm needs to start an evasion
  double pass_horizon_s = 0.5;        ///< look-ahead for the closest approach
  double comfort_clearance_m = 0.16;  ///< comfort tier: preferred distance, traded against the nominal velocity
  double comfort_gain_per_s = 4.0;    ///< approach speed per metre above comfort_clearance_m
  double comfort_far_m = 0.4;    ///< comfort_weight applies at this distance of the tool from the target and beyond
  double comfort_near_m = 0.15;  ///< comfort_least_weight applies at this distance and below; linear in between
  double comfort_least_weight = 0.2;  ///< s2/m2
  double comfort_weight = 1000.0;     ///< s2/m2
  double person_clearance_m = 0.6;    ///< separation: preferred distance from a person in TRACK, also at the target
  double person_gain_per_s = 2.0;     ///< approach speed per metre above person_clearance_m
  double person_weight = 1000.0;      ///< s2/m2; of the speed that is missing
  /// w of the programme, 1/m2: cost of tool velocity error relative to joint velocity error; less far from the target
  /// (cycle.cpp)
  double tool_weight = 600.0;
  double self_clearance_m = 0.02;  ///< between two links, at most (load/self_pairs.h)
  double range_m = 0.4;            ///< pairs farther apart, now and within pass_horizon_s, are ignored
};

/// Look-ahead and planning beside the cycle (foresight/).
struct ForesightSettings {
  bool enabled = true;        ///< off for experiments only
  double horizon_s = 6.0;     ///< length of a rollout
  double clearance_m = 0.04;  ///< least clearance along a guide
  int64_t seed = 1;           ///< of the planner's random numbers
};

/// Largest ages of the inputs by local receipt time, the reaction beyond them, and two durations.
struct Timeouts {
  double target_s = 0.250;          ///< then mode HOLD
  double obstacles_s = 0.100;       ///< then mode BRAKE
  double arm_state_s = 0.030;       ///< then mode BRAKE
  double arm_state_lost_s = 0.100;  ///< then mode FAULT
  double consistent_s = 0.5;        ///< duration of consistent arm states that is required before the arm moves
  double control_s = 0.0;           ///< then mode HOLD; 0: no operator is needed
  double coast_s = 0.3;  ///< how long a jumped, shrunk or vanished obstacle is remembered (obstacle_memory.h)
};

/// Measurement errors of reported obstacles. The latency adds to the age of an obstacle set, the other two to its
/// growth (control/extrapolation.h).
struct ObstacleTrust {
  double latency_s = 0.0;                ///< from the measurement to the receipt; obstacles are extrapolated by it
  double uncertainty_m = 0.0;            ///< of a reported position
  double acceleration_bound_mps2 = 0.0;  ///< a in the growth of obstacles (control/extrapolation.h)
};

/// The settings of the control cycle. Read from YAML by io/config.
struct Settings {
  Law law = Law::kSidestep;
  double rate_hz = 100.0;
  PaperGains paper;
  Timeouts timeouts;
  SidestepGains sidestep;
  ShieldSettings shield;
  ForesightSettings foresight;
  bool wait_for_obstacles = true;  ///< false: before the first obstacle set there are no obstacles
  ObstacleTrust obstacle_trust;
  /// The speed that an obstacle may have whatever velocity is reported: for the growth of obstacles
  /// (control/extrapolation.h) and for jumps (control/obstacle_memory.h).
  double obstacle_speed_bound_mps = 2.0;
  bool estimates_motion = true;      ///< of obstacles (motion_estimator.h); false with the paper's law
  bool bounds_target_speed = true;   ///< of the target's own velocity (extrapolation.h); false with the paper's law
  double start_guard_s = 0.0;        ///< after the first state of an arm driver, no command is sent for this time
  bool bridges_outliers = true;      ///< false in rollouts: a state out of reach is a jump there, never an outlier
  double following_error_rad = 0.5;  ///< tolerated |measured - commanded position| per joint; times
                                     ///< Arm::joint_scale for a prismatic one (command_stream.h)

  double period_s() const { return 1.0 / rate_hz; }
};

/// Chooses the law. The paper's law runs as published: without shield, foresight and obstacle memory, and
/// with the target's velocity as it is.
void use_law(Settings& settings, Law law);

}  // namespace sidestep
