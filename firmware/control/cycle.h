#pragma once

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "firmware/control/message_order.h"
#include "firmware/control/stages.h"
#include "firmware/control/supervisor.h"
#include "firmware/control/types/guide.h"
#include "firmware/model/clearance.h"

namespace sidestep {

/// The controller's knowledge that does not change while it runs.
struct Model {
  Arm arm;
  Settings settings;
  std::vector<std::pair<int, int>> self_pairs;  ///< link shapes that must keep clear of each other
  std::vector<Obstacle> surroundings;           ///< always there, at rest, whatever is reported
};

/// What one cycle is given. Messages are already checked (io/admission); they stay valid during the call.
struct Inputs {
  Latest<ArmState> arm;
  Latest<Target> target;
  Latest<ObstacleSet> obstacles;
  int skipped_cycles = 0;  ///< since the cycle before
  bool stop = false;
  double foreign_command_s = -HUGE_VAL;  ///< when somebody else's command for this arm was heard last
  const Guide* guide = nullptr;          ///< from foresight; null: none
};

/// What one cycle hands to the next.
struct State {
  Supervision supervision;

  bool commanding = false;     ///< a command stream is running; it goes on from the next two
  JointVector position_rad;    ///< last commanded
  JointVector velocity_radps;  ///< last commanded
  JointVector rate_radps;      ///< at which the commanded position moved: the velocity, unless it was catching up

  JointVector evasion_radps;  ///< by which the shield gets out of a way; size 0: nothing is in the way

  bool planning = false;  ///< was tracking, so that planned_mps is valid
  Vector3 planned_mps = Vector3::Zero();

  int64_t arm_count = 0;  ///< of the arm state seen last, and what it said:
  int64_t arm_utime = 0;
  double arm_received_s = 0.0;
  double arm_started_s = 0.0;  ///< when its driver began to speak
  JointVector arm_position_rad;
  JointVector arm_rate_radps;  ///< from the position before to this one
  double consistent_since_s = 0.0;
  int skipped_in_a_row = 0;
  double cycle_s = 0.0;          ///< when the last cycle was
  double stopped_s = -HUGE_VAL;  ///< when the arm last stopped by itself for want of commands
};

/// The running stream of commands, if any, has come to rest.
bool at_rest(const State& state);

/// What one cycle tells the world, as controller_status_t.
struct Report {
  Mode mode = Mode::kWait;
  Fault fault = Fault::kNone;
  int limiting = kLimitingNothing;
  Vector3 tool_position_m = Vector3::Zero();
  Vector3 tool_velocity_mps = Vector3::Zero();
  double target_distance_m = std::numeric_limits<double>::quiet_NaN();  ///< NaN without a target
  double clearance_m = std::numeric_limits<double>::quiet_NaN();        ///< NaN before the first obstacle set
  int32_t nearest_obstacle = -1;                                        ///< its id
  int nearest_shape = -1;                                               ///< index into Arm::shapes
  double beta = 0.0;
  double damping = 0.0;
  double shield_correction_radps = 0.0;
  ForesightStatus foresight_status = ForesightStatus::kDirect;
  double guide_horizon_s = 0.0;  ///< until the guide's end; 0 without one
  const Guide* guide = nullptr;  ///< followed in this cycle, of the inputs
  const char* message = "";
};

struct Result {
  bool commanding = false;  ///< the command belongs to a running stream; false while waiting and after a fault
  Command command;          ///< valid as soon as an arm state is known; until then of size 0
  Report report;
  State next;
};

/// One control cycle at time now_s: a pure function, bounded, without allocation, clock or I/O.
///
/// now_s is on the clock of the inputs' receipt times. Call it once a period, Settings::period_s(); every command
/// continues the last one within the joints' velocity, acceleration and position limits. A probe hears when the stages
/// end, as far as there are any before the first arm state; it changes nothing.
Result step(const Model& model, const State& state, const Inputs& inputs, double now_s, StageProbe* probe = nullptr);

}  // namespace sidestep
