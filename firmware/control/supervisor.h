#pragma once

#include "firmware/control/types/messages.h"

namespace sidestep {

/// What the supervisor knows in one cycle.
struct InputStatus {
  bool arm_known = false;         ///< an arm state was ever received
  bool arm_fresh = false;         ///< young enough to act on
  bool arm_lost = false;          ///< older than what a short gap may be
  bool arm_consistent = false;    ///< consistent for as long as it has to be
  bool arm_starting = false;      ///< began to speak so recently that it must not hear a command
  bool arm_inconsistent = false;  ///< this cycle's arm state contradicts the one before
  bool obstacles_known = false;   ///< a set was received, or none is needed
  bool obstacles_fresh = false;
  bool target_known = false;
  bool target_fresh = false;
  bool late = false;             ///< too many cycles in a row were skipped
  bool stop = false;             ///< somebody wants the controller to end
  bool foreign_command = false;  ///< another controller has just sent commands to the same arm
};

/// Mode, what led to it, and both in words.
struct Supervision {
  Mode mode = Mode::kWait;
  Fault fault = Fault::kNone;
  const char* message = "starting";
};

/// The law and the shield have a say; in all other modes commands brake or rest.
inline bool moves(Mode mode) {
  return mode == Mode::kHold || mode == Mode::kTrack;
}

/// The modes and their transitions:
///
///   WAIT  -> HOLD   the arm state is consistent, the obstacles are known and fresh
///   HOLD <-> TRACK  there is a fresh target; HOLD slows to rest and goes on avoiding
///   any  <-> BRAKE  arm state or obstacles too old, late, a rival, or asked to stop: to rest as fast as the joints can
///   any   -> FAULT  arm state lost or contradictory, or a wish that is not finite; from there as from WAIT
Supervision next_mode(const Supervision& last, const InputStatus& status);

}  // namespace sidestep
