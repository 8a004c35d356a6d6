#pragma once

#include "firmware/control/types/messages.h"

namespace sidestep {

/// What input monitoring finds in one cycle (input_monitor.h); the input of the supervisor.
struct InputStatus {
  bool arm_known = false;       ///< an arm state was ever accepted
  bool arm_fresh = false;       ///< not older than timeouts.arm_state_s
  bool arm_lost = false;        ///< older than timeouts.arm_state_lost_s
  bool arm_consistent = false;  ///< consistent for timeouts.consistent_s without interruption
  bool arm_starting = false;    ///< its driver started less than Settings::start_guard_s ago: must not receive commands
  bool arm_inconsistent = false;  ///< this cycle's arm state cannot follow the one before
  bool obstacles_known = false;   ///< a set was accepted, or none is required
  bool obstacles_fresh = false;   ///< not older than timeouts.obstacles_s
  bool target_known = false;
  bool target_fresh = false;     ///< not older than timeouts.target_s
  bool late = false;             ///< 3 or more cycles in a row were skipped
  bool stop = false;             ///< the process has been asked to end
  bool foreign_command = false;  ///< another controller commanded the arm within timeouts.consistent_s
};

/// Mode, fault and the reason for both in words.
struct Supervision {
  Mode mode = Mode::kWait;
  Fault fault = Fault::kNone;
  const char* message = "starting";
};

/// Law and shield choose the command; in all other modes commands brake or rest.
inline bool moves(Mode mode) {
  return mode == Mode::kHold || mode == Mode::kTrack;
}

/// The modes and their transitions. "Ready" means: arm state fresh, consistent for 0.5 s and not starting, no stop
/// request, no foreign command, obstacles known and fresh. All times are timeouts of the configuration.
///
///   WAIT         -> HOLD   ready
///   HOLD        <-> TRACK  the target is fresh (250 ms); HOLD slows to rest and keeps avoiding obstacles
///   HOLD, TRACK <-> BRAKE  arm state older than 30 ms, obstacles older than 100 ms, 3 cycles in a row skipped, a
///   foreign
///                          command or a stop request: every joint brakes at its acceleration limit
///   HOLD, TRACK,
///   BRAKE        -> FAULT  arm state older than 100 ms, arm state inconsistent, or a command that is not finite
///   FAULT        -> HOLD   ready
///   FAULT        -> WAIT   ready, but no obstacle set is known
Supervision next_mode(const Supervision& last, const InputStatus& status);

}  // namespace sidestep
