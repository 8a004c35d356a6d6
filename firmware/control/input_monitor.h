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
  int skipped_in_a_row = 0;         ///< cycles skipped since the last cycle on time, the last one with
                                    ///< Inputs::skipped_cycles = 0
  double cycle_s = 0.0;             ///< time of the last cycle
};

/// Whether the arm can still be executing the command stream; the input of the command stream (command_stream.h).
/// An arm driver stops the arm by itself when it receives no command for 50 ms.
struct ArmContinuity {
  bool arm_follows = true;          ///< false: a silence or a jump of its clock has ended, and the arm is out of reach
  bool cycles_paused = false;       ///< no cycle for max(50 ms, 1.5 periods): the driver may have stopped the arm
  double arm_waited_until_s = 0.0;  ///< when the driver has received no command for so long that it stops the arm
  bool clock_went_back = false;     ///< this cycle is earlier than the previous one: stored times are not comparable
  double arm_received_s = 0.0;      ///< receipt of the newest accepted arm state
};

struct MonitorResult {
  InputStatus status;
  ArmContinuity continuity;
};

/// Compares the ages of the inputs with their timeouts and the arm state with the ones before. One arm state is within
/// reach of another if no joint has moved farther than its velocity limit allows in the elapsed time plus one period,
/// plus 1 mrad of sensor noise. Arm states are consistent when no gap exceeds timeouts.arm_state_lost_s, their utime
/// advances, and each is within reach of the one before.
///
/// Outliers: a state that is out of reach of both last accepted states counts as a message that was not received.
/// The last accepted state remains the arm of the cycle, and its age grows. (Of both, because a slightly wrong
/// state may have been accepted; the correct state after it is within reach of the one before.) Outliers for longer
/// than timeouts.arm_state_lost_s are a jump of the arm: the arm is inconsistent, and the next state is accepted.
/// `monitor` is updated.
MonitorResult monitor_inputs(const Model& model, const Inputs& inputs, double now_s, ArmMonitor& monitor);

}  // namespace sidestep
