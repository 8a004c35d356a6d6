#pragma once

#include "firmware/control/types/messages.h"

namespace sidestep {

/// What input monitoring finds in one cycle (input_monitor.h); the input of the supervisor.
struct InputStatus {
  bool arm_known = false;       ///< an arm state was ever accepted
  bool arm_fresh = false;       ///< the accepted arm state is not older than timeouts.arm_state_s
  bool arm_lost = false;        ///< it is older than timeouts.arm_state_lost_s
  bool arm_consistent = false;  ///< consistent for timeouts.consistent_s without interruption
  bool arm_starting = false;    ///< its driver started less than Settings::start_guard_s ago: must not receive commands
  bool arm_inconsistent = false;  ///< the arm jumped, or its clock did not advance (input_monitor.h)
  bool obstacles_known = false;   ///< a set was accepted, or none is required
  bool obstacles_fresh = false;   ///< not older than timeouts.obstacles_s, or none received and none required
  bool target_known = false;
  bool target_fresh = false;            ///< not older than timeouts.target_s
  bool target_out_of_reach = false;     ///< the tool cannot get there: certain, or found by foresight
  bool posture_blocked = false;         ///< found by foresight: too near to an obstacle or to the arm itself
  bool posture_outside_limits = false;  ///< a posture target is outside the position limits, and clamped to them
  bool late = false;                    ///< 3 or more cycles were skipped since the last cycle on time
  bool stop = false;                    ///< the process has been asked to end
  bool paused = false;                  ///< by the operator
  bool operator_silent = false;  ///< an operator is needed, and the newest control message is older than its timeout
  bool foreign_command = false;  ///< another controller commanded the arm within timeouts.consistent_s
};

/// Mode, fault and the reason for both in words.
struct Supervision {
  Mode mode = Mode::kWait;
  Fault fault = Fault::kNone;
  const char* message = "starting";
};

/// HOLD and TRACK: the arm follows the law, or rests where there is no target. In all other modes it stops.
inline bool moves(Mode mode) {
  return mode == Mode::kHold || mode == Mode::kTrack;
}

/// The modes and their transitions. All ages and durations are timeouts of the configuration; their defaults are given.
/// "Ready": the arm state is fresh (30 ms), consistent for 0.5 s and its driver is not starting; no stop request; no
/// foreign command; obstacles are known and fresh (100 ms). In every cycle the first line that applies decides.
///
///   from                to     when
///   WAIT                HOLD   ready
///   HOLD, TRACK, BRAKE  FAULT  arm state older than 100 ms; the arm jumped; its clock did not advance.
///                              step() also sets FAULT when a result is not finite
///   FAULT               HOLD   ready
///   HOLD, TRACK, BRAKE  BRAKE  stop request; foreign command; arm state older than 30 ms; obstacles older than 100 ms;
///                              3 or more skipped cycles since the last cycle on time
///   HOLD, TRACK, BRAKE  HOLD   paused; the operator is silent (only where timeouts.control_s is set)
///   HOLD, TRACK, BRAKE  TRACK  the target is fresh (250 ms); the message says so if it cannot be reached
///   HOLD, TRACK, BRAKE  HOLD   otherwise
///
/// HOLD slows to rest and keeps avoiding obstacles. So does BRAKE while arm state and obstacles are fresh; after a stop
/// request without comfort, so that it comes to rest. Otherwise BRAKE, like FAULT, brings every joint to rest within
/// bounded time (braking_range() in command_stream.h): the shield then takes the commanded arm for one that is not
/// measured, and the last obstacle set, extrapolated. BRAKE ends as soon as its cause has ended.
Supervision next_mode(const Supervision& last, const InputStatus& status);

}  // namespace sidestep
