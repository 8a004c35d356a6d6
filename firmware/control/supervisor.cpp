#include "firmware/control/supervisor.h"

namespace sidestep {
namespace {

/// From WAIT or FAULT: HOLD when everything is ready, else the given mode with the reason.
Supervision start(const InputStatus& status, Mode mode, Fault fault) {
  if (!status.arm_known) return {mode, fault, "waiting for the first arm state"};
  if (!status.arm_fresh) return {mode, fault, "waiting for arm states; the last one is too old"};
  if (!status.arm_consistent) return {mode, fault, "waiting for consistent arm states"};
  if (status.arm_starting) return {mode, fault, "waiting: the driver of the arm has only just started"};
  if (status.stop) return {mode, fault, "stopping"};
  if (status.foreign_command) return {mode, fault, "waiting: another controller commands the arm"};
  if (!status.obstacles_known) return {Mode::kWait, Fault::kNone, "waiting for the first obstacle set"};
  if (!status.obstacles_fresh) return {mode, fault, "waiting: the obstacles are too old"};
  return {Mode::kHold, Fault::kNone, "holding"};
}

const char* tracking_message(const InputStatus& status) {
  if (status.target_out_of_reach) return "tracking as near as the arm can: the target is out of reach";
  if (status.posture_outside_limits)
    return "tracking as near as the arm can: the posture is outside the position limits";
  if (status.posture_blocked)
    return "tracking as near as the arm can: the posture is too near to an obstacle or to the arm itself";
  return "tracking";
}

}  // namespace

Supervision next_mode(const Supervision& last, const InputStatus& status) {
  if (last.mode == Mode::kWait) return start(status, Mode::kWait, Fault::kNone);
  if (status.arm_inconsistent) return {Mode::kFault, Fault::kArmStateInconsistent, "fault: the arm state jumped"};
  if (status.arm_lost) return {Mode::kFault, Fault::kArmStateLost, "fault: no arm state"};
  if (last.mode == Mode::kFault) return start(status, Mode::kFault, last.fault);

  if (status.stop) return {Mode::kBrake, Fault::kNone, "braking: asked to stop"};
  if (status.foreign_command) return {Mode::kBrake, Fault::kNone, "braking: another controller commands the arm"};
  if (!status.arm_fresh) return {Mode::kBrake, Fault::kNone, "braking: the last consistent arm state is too old"};
  if (!status.obstacles_fresh) return {Mode::kBrake, Fault::kNone, "braking: the obstacles are too old"};
  if (status.late) return {Mode::kBrake, Fault::kNone, "braking: too many cycles in a row were skipped"};
  if (status.paused) return {Mode::kHold, Fault::kNone, "holding: paused"};
  if (status.operator_silent) return {Mode::kHold, Fault::kNone, "holding: the operator is silent"};
  if (!status.target_known) return {Mode::kHold, Fault::kNone, "holding: no target yet"};
  if (!status.target_fresh) return {Mode::kHold, Fault::kNone, "holding: the target is too old"};
  return {Mode::kTrack, Fault::kNone, tracking_message(status)};
}

}  // namespace sidestep
