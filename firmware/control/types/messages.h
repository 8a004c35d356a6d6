#pragma once

#include <cstdint>

#include "firmware/model/obstacle.h"
#include "firmware/model/types.h"

namespace sidestep {

/// The inputs and outputs of a control cycle as values. Their wire formats are in lcmtypes/. Joint values are in rad
/// and rad/s, or m and m/s for a prismatic joint.

/// The measured arm. utime is the sender's clock in microseconds.
struct ArmState {
  int64_t utime = 0;
  JointVector position_rad;
  JointVector velocity_radps;
  JointVector held_rad{};  ///< position that the drives hold, where the driver reports it; size 0: not reported
};

/// The goal: of the tool, base frame (with tracks_orientation a full pose), or a posture of the whole arm.
struct Target {
  int64_t utime = 0;
  Vector3 position_m = Vector3::Zero();
  Vector3 velocity_mps = Vector3::Zero();
  bool tracks_orientation = false;
  Quaternion orientation = Quaternion::Identity();
  Vector3 angular_velocity_radps = Vector3::Zero();
  JointVector posture_rad{};  ///< n x 1; size 0: the goal is of the tool. With a posture the other fields are neutral;
                              ///< in a cycle position_m is the tool's place in the posture (extrapolation.h)

  bool is_posture() const { return posture_rad.size() > 0; }
};

/// What an operator asks for.
enum class ControlCommand : int8_t { kPause = 0, kResume = 1, kStop = 2 };  // values as in control_t
struct Control {
  int64_t utime = 0;
  ControlCommand command = ControlCommand::kResume;
  double speed_scale = 1.0;  ///< 0 to 1, of the nominal velocity in TRACK
};

/// The output of a cycle. position_rad is the last commanded position + velocity_radps * period; while the command
/// closes a large following error, a correction is added to it (command_stream.h).
struct Command {
  JointVector position_rad;
  JointVector velocity_radps;  ///< for the coming period
};

/// Values as in controller_status_t; a unit test compares them.
enum class Mode : int8_t { kWait = 0, kHold = 1, kTrack = 2, kBrake = 3, kFault = 4 };
enum class Fault : int32_t { kNone = 0, kArmStateLost = 1, kArmStateInconsistent = 2, kNotFinite = 3 };

/// Bit set of what changed the command in this cycle, or degrades the process.
enum Limiting : int32_t {
  kLimitingNothing = 0,
  kLimitingVelocity = 1,
  kLimitingAcceleration = 2,
  kLimitingPosition = 4,
  kLimitingTaskSpeed = 8,
  kLimitingShield = 16,
  kLimitingNotRealtime = 32,
  kLimitingLate = 64,
  kLimitingNoBlackbox = 1024,
  kLimitingShieldFailed = 2048,
  kLimitingSelf = 4096,
};

}  // namespace sidestep
