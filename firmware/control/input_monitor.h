#pragma once

#include "firmware/control/supervisor.h"
#include "firmware/control/types/inputs.h"
#include "firmware/control/types/model.h"

namespace sidestep {

/// An arm state with the time of its receipt.
struct AcceptedArmState {
  ArmState state;
  double received_s = 0.0;
};

/// What input monitoring stores from one cycle to the next.
struct ArmMonitor {
  int64_t count = 0;                ///< of the newest arm state received, accepted or not
  double received_s = 0.0;          ///< its receipt
  AcceptedArmState accepted;        ///< the newest state that is no outlier: the arm of the cycle
  AcceptedArmState before;          ///< the one accepted before it
  JointVector rate_radps;           ///< difference quotient of the last two accepted positions
  double driver_started_s = 0.0;    ///< first state of the present arm driver
  double consistent_since_s = 0.0;  ///< since then arm states have been consistent
  int skipped_in_a_row = 0;         ///< cycles skipped since the last cycle on time, which is one with
                                    ///< Inputs::skipped_cycles = 0
  double cycle_s = 0.0;             ///< time of the last cycle
};

/// Whether the arm can still be executing the command stream; the input of the command stream (command_stream.h).
/// An arm driver stops the arm by itself when it receives no command for 50 ms.
struct ArmContinuity {
  bool arm_follows = true;          ///< false in the first state after a silence of the arm, or after a jump of its
                                    ///< clock, if this state is out of reach
  bool cycles_paused = false;       ///< no cycle for max(50 ms, 1.5 periods): the driver may have stopped the arm
  double arm_waited_until_s = 0.0;  ///< if cycles_paused: the time at which the driver stopped waiting for a command
  bool clock_went_back = false;     ///< this cycle is earlier than the previous one: stored times are not comparable
  double arm_received_s = 0.0;      ///< receipt of the newest accepted arm state
};

struct MonitorResult {
  InputStatus status;
  ArmContinuity continuity;
  double speed_scale = 1.0;  ///< as the operator asks for; 0 while paused, or silent where an operator is needed
};

/// Compares the ages of the inputs with their timeouts and the arm state with the ones accepted before. One arm state
/// is within reach of another if no joint has moved farther than its velocity limit allows in the elapsed time plus one
/// period, plus 1 mrad (1 mm) of sensor noise.
///
/// consistent_since_s starts anew when a gap exceeds timeouts.arm_state_lost_s, when the utime does not advance, and
/// when a state is out of reach of the last accepted one. This alone does not stop a moving arm.
///
/// An outlier is a state that is out of reach of the last accepted state and of the one accepted before that. It counts
/// as a message that was not received: the last accepted state remains the arm of the cycle, and its age grows. A state
/// within reach of one of the two is accepted; thus a correct state is accepted after a slightly wrong one.
///
/// InputStatus::arm_inconsistent, which stops the arm, is set in two cases: the utime does not advance; outliers have
/// lasted for longer than timeouts.arm_state_lost_s, a jump of the arm, after which the next state is accepted.
/// `monitor` is updated.
MonitorResult monitor_inputs(const Model& model, const Inputs& inputs, double now_s, ArmMonitor& monitor);

}  // namespace sidestep
