#pragma once

#include <cstdint>

#include "firmware/model/obstacle.h"
#include "firmware/model/types.h"

namespace sidestep {

/// What goes in and out of a control cycle, as values. The wire formats behind them are in lcmtypes/.

struct ArmState {
  int64_t utime = 0;
  JointVector position_rad;
  JointVector velocity_radps;
  JointVector held_rad{};  ///< what the drives are told to hold, where they say so; size 0: not known
};

struct Target {
  int64_t utime = 0;
  Vector3 position_m = Vector3::Zero();
  Vector3 velocity_mps = Vector3::Zero();
  bool tracks_orientation = false;
  Quaternion orientation = Quaternion::Identity();
  Vector3 angular_velocity_radps = Vector3::Zero();
};

struct Command {
  JointVector position_rad;    ///< where the velocity leads in one period; beside that while an arm is caught up with
  JointVector velocity_radps;  ///< for the coming period
};

/// Values as in controller_status_t.
enum class Mode : int8_t { kWait = 0, kHold = 1, kTrack = 2, kBrake = 3, kFault = 4 };
enum class Fault : int32_t { kNone = 0, kArmStateLost = 1, kArmStateInconsistent = 2, kNotFinite = 3 };
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
};

}  // namespace sidestep
