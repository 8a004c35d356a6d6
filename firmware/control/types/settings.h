#pragma once

#include "firmware/model/types.h"

namespace sidestep {

enum class Law { kSidestep, kPaper };
enum class ToolVelocity { kMeasured, kPlanned };

/// Parameters of the paper's law; symbols and starting values from paper-notes.md, "Parameters".
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

/// The law of our own: where the tool shall go, before the shield.
struct SidestepGains {
  double k_pos_per_s = 8.0;          ///< tool speed over distance to the target
  double k_ori_per_s = 4.0;          ///< likewise for the angle, when the target asks for an orientation
  double k_posture_per_s = 0.5;      ///< return of the joints from their limits, as far as the tool does not notice
  double k_guide_per_s = 4.0;        ///< return of the joints to the way of a guide
  double guide_posture_share = 0.5;  ///< of the joints' speed, at most, to the posture of a guide while at the target
  double v_max_mps = 1.0;            ///< largest tool speed toward the target, beside the target's own
  double lambda_0 = 0.05;            ///< largest damping near singular postures, paper eq (6)
  double sigma_0 = 0.05;             ///< damping begins below this singular value
};

/// The shield: the joint velocity nearest to the wish that keeps clear.
struct ShieldSettings {
  bool enabled = true;             ///< off for experiments only
  double hard_clearance_m = 0.02;  ///< never given up while the limits allow
  double hard_gain_per_s = 15.0;   ///< clearance above it may shrink by this share a second
  double pass_clearance_m = 0.04;  ///< at the closest approach of a moving obstacle
  double pass_gain_per_s = 6.0;
  double pass_reaction_s = 0.12;      ///< the arm's own time to get moving
  double pass_horizon_s = 0.5;        ///< how far ahead an obstacle's way is looked at
  double comfort_clearance_m = 0.16;  ///< kept where the task leaves room
  double comfort_gain_per_s = 4.0;
  double comfort_far_m = 0.4;         ///< with the tool farther than this from the target comfort has its full weight,
  double comfort_near_m = 0.15;       ///< nearer than this the least: then it may move the arm but hardly the tool
  double comfort_least_weight = 0.2;  ///< s2/m2
  double comfort_weight = 1000.0;     ///< of the comfort against the wish, s2/m2
  double tool_weight = 60.0;          ///< of the tool's velocity against the joints', 1/m2
  double self_clearance_m = 0.02;     ///< between links that are no neighbours
  double range_m = 0.4;               ///< pairs farther apart do not matter yet
};

/// Looking ahead for ways out of dead ends.
struct ForesightSettings {
  bool enabled = true;        ///< off for experiments only
  double horizon_s = 6.0;     ///< how far ahead
  double clearance_m = 0.04;  ///< of a guide
  int64_t seed = 1;           ///< of its random choices
};

/// Ages by local receipt time after which an input no longer counts, s, and what happens then.
struct Timeouts {
  double target_s = 0.250;          ///< brake to hold
  double obstacles_s = 0.100;       ///< brake
  double arm_state_s = 0.030;       ///< brake
  double arm_state_lost_s = 0.100;  ///< fault
  double consistent_s = 0.5;        ///< of arm state before anything moves
  double coast_s = 0.3;             ///< of an obstacle that has jumped or vanished: so long it counts
};

/// How far reports of obstacles can be trusted; each adds to the distance that is kept, as in ISO/TS 15066.
struct ObstacleTrust {
  double latency_s = 0.0;                ///< from the measurement to the receipt: moved forward by it
  double uncertainty_m = 0.0;            ///< of a reported position
  double acceleration_bound_mps2 = 0.0;  ///< by which an obstacle may leave its constant velocity since then
};

/// Everything a control cycle is told before it starts. Read from YAML by io/config.
struct Settings {
  Law law = Law::kSidestep;
  double rate_hz = 100.0;
  PaperGains paper;
  Timeouts timeouts;
  SidestepGains sidestep;
  ShieldSettings shield;
  ForesightSettings foresight;
  bool wait_for_obstacles = true;  ///< false: no obstacle set ever received counts as no obstacles
  ObstacleTrust obstacle_trust;
  double obstacle_speed_bound_mps = 2.0;  ///< how fast an obstacle that is no longer reported may move
  double start_guard_s = 0.0;             ///< so long after its first state an arm must not be sent any command
  double following_error_rad = 0.5;       ///< how far the command may lead the measured arm, per joint

  double period_s() const { return 1.0 / rate_hz; }
};

}  // namespace sidestep
