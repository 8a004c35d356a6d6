#pragma once

#include <limits>

#include "firmware/control/command_stream.h"
#include "firmware/control/guided_law.h"
#include "firmware/control/input_monitor.h"
#include "firmware/control/shield/shield.h"
#include "firmware/control/stages.h"
#include "firmware/control/supervisor.h"
#include "firmware/control/types/inputs.h"
#include "firmware/control/types/model.h"

namespace sidestep {

/// The commanded tool velocity of the last cycle; valid if the last cycle was in TRACK. Only the paper's law uses it.
struct PlannedVelocity {
  bool valid = false;
  Vector3 velocity_mps = Vector3::Zero();
};

/// What one cycle hands to the next, grouped by the part of the cycle that owns it.
struct State {
  Supervision supervision;    ///< supervisor.h
  ArmMonitor arm_monitor;     ///< input_monitor.h
  CommandStream stream;       ///< command_stream.h
  JointVector evasion_radps;  ///< evasion chosen by the shield in the last cycle; size 0: none (shield.h)
  PlannedVelocity planned;
  GuideProgress guide_progress;  ///< guided_law.h
};

/// The report of one cycle, published as controller_status_t.
struct Report {
  Mode mode = Mode::kWait;
  Fault fault = Fault::kNone;
  int limiting = kLimitingNothing;
  Vector3 tool_position_m = Vector3::Zero();
  Vector3 tool_velocity_mps = Vector3::Zero();
  double target_distance_m = std::numeric_limits<double>::quiet_NaN();  ///< of the tool; NaN without a target
  double clearance_m = std::numeric_limits<double>::quiet_NaN();        ///< NaN while no obstacle is known
  int32_t nearest_obstacle = -1;                                        ///< its id
  int nearest_shape = -1;                                               ///< index into Arm::shapes
  NearestLinks nearest_links;                                           ///< none with the shield off or while waiting
  double beta = 0.0;
  double damping = 0.0;
  double shield_correction_radps = 0.0;  ///< |safe - nominal|
  ForesightStatus foresight_status = ForesightStatus::kDirect;
  double guide_horizon_s = 0.0;  ///< until the end of the guide; 0 without one
  const Guide* guide = nullptr;  ///< the guide of the inputs, where this cycle followed it
  double speed_scale = 1.0;      ///< as the operator asks for; 0 while paused
  const char* message = "";      ///< static text
};

struct Result {
  bool commanding = false;  ///< the command stream runs (command_stream.h): the command is to be sent
  Command command;          ///< of size 0 before the first arm state
  Report report;
  State next;
};

/// One control cycle at time now_s: a pure, bounded function without allocation, clock or I/O.
///
///   monitor_inputs      fresh? ordered? consistent?                      input_monitor.h
///   next_mode           WAIT, HOLD, TRACK, BRAKE, FAULT                   supervisor.h
///   forward_kinematics  link poses, tool Jacobian                         model/kinematics.h
///   measure_clearance   distances and closest approaches                  model/clearance.h
///   law                 nominal joint velocity                            sidestep_law.h, posture_law.h, paper/, ...
///   shield              the nearest safe joint velocity                   shield/shield.h
///   gate                finite, continuous, within the joint limits       command_stream.h
///
/// now_s is on the clock of the inputs' receipt times. Call step() once per Settings::period_s(). While a command
/// stream runs, every command continues the last one within the joints' velocity, acceleration and position limits; an
/// arm that was pushed past a limit returns within the acceleration limit. The probe is called at the end of each stage
/// that runs and does not influence the result.
Result step(const Model& model, const State& state, const Inputs& inputs, double now_s, StageProbe* probe = nullptr);

}  // namespace sidestep
