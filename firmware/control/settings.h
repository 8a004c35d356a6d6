#pragma once

#include <string>

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

/// Ages by local receipt time after which an input no longer counts, s, and what happens then.
struct Ages {
  double target_s = 0.250;          ///< brake to hold
  double obstacles_s = 0.100;       ///< brake
  double arm_state_s = 0.030;       ///< brake
  double arm_state_lost_s = 0.100;  ///< fault
  double consistent_s = 0.5;        ///< of arm state before anything moves
};

/// Everything a control cycle is told before it starts. Read from YAML by io/config.
struct Settings {
  Law law = Law::kSidestep;
  double rate_hz = 100.0;
  PaperGains paper;
  Ages ages;
  bool shield_enabled = true;             ///< of the sidestep law; off for experiments only
  bool foresight_enabled = true;          ///< likewise
  bool wait_for_obstacles = true;         ///< false: no obstacle set ever received counts as no obstacles
  double obstacle_speed_bound_mps = 2.0;  ///< how fast an obstacle that is no longer reported may move
  double near_range_m = 0.4;              ///< obstacles farther from the arm than this do not matter yet
  double following_error_rad = 0.1;       ///< largest distance of the command ahead of the measured arm, per joint

  double period_s() const { return 1.0 / rate_hz; }
};

}  // namespace sidestep
