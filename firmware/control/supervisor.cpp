#include "firmware/control/supervisor.h"

namespace sidestep {
namespace {

Supervision start(const Facts& facts, Mode mode, Fault fault) {
  if (!facts.arm_known) return {mode, fault, "waiting for the first arm state"};
  if (!facts.arm_fresh) return {mode, fault, "waiting for arm states; the last one is too old"};
  if (!facts.arm_consistent) return {mode, fault, "waiting for consistent arm states"};
  if (facts.arm_starting) return {mode, fault, "waiting: the driver of the arm has only just started"};
  if (facts.stop) return {mode, fault, "stopping"};
  if (facts.rival) return {mode, fault, "waiting: another controller commands the arm"};
  if (!facts.obstacles_known) return {Mode::kWait, Fault::kNone, "waiting for the first obstacle set"};
  if (!facts.obstacles_fresh) return {mode, fault, "waiting: the obstacles are too old"};
  return {Mode::kHold, Fault::kNone, "holding"};
}

}  // namespace

Supervision next_mode(const Supervision& last, const Facts& facts) {
  if (last.mode == Mode::kWait) return start(facts, Mode::kWait, Fault::kNone);
  if (facts.arm_broke) return {Mode::kFault, Fault::kArmStateInconsistent, "fault: the arm state jumped"};
  if (facts.arm_lost) return {Mode::kFault, Fault::kArmStateLost, "fault: no arm state"};
  if (last.mode == Mode::kFault) return start(facts, Mode::kFault, last.fault);

  if (facts.stop) return {Mode::kBrake, Fault::kNone, "braking: asked to stop"};
  if (facts.rival) return {Mode::kBrake, Fault::kNone, "braking: another controller commands the arm"};
  if (!facts.arm_fresh) return {Mode::kBrake, Fault::kNone, "braking: the arm state is too old"};
  if (!facts.obstacles_fresh) return {Mode::kBrake, Fault::kNone, "braking: the obstacles are too old"};
  if (facts.late) return {Mode::kBrake, Fault::kNone, "braking: too many cycles in a row were skipped"};
  if (!facts.target_known) return {Mode::kHold, Fault::kNone, "holding: no target yet"};
  if (!facts.target_fresh) return {Mode::kHold, Fault::kNone, "holding: the target is too old"};
  return {Mode::kTrack, Fault::kNone, "tracking"};
}

}  // namespace sidestep
