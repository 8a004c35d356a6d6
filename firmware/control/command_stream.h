#pragma once

#include <cmath>

#include "firmware/control/input_monitor.h"
#include "firmware/control/types/inputs.h"
#include "firmware/control/types/model.h"
#include "firmware/model/velocity_range.h"

namespace sidestep {

/// The stream of commands to the arm. It starts from the position that the drives hold, or from the measured one; then
/// every command continues the last one. It ends in FAULT once at rest, and when the arm cannot be following it any
/// more.
///
/// Catching up. The commanded position normally moves with the commanded velocity. Where the arm lags behind or was
/// pushed, the commanded position also moves toward the measured one. Per joint, with the error
/// e = measured - commanded position and F = Settings::following_error_rad (times Arm::joint_scale), the part of e to
/// be closed is
///   0               for |e| <= F/2
///   |e| - F/2       for F/2 < |e| <= F
///   |e|             for |e| > F
/// The first line is for an arm that lags a little behind its command, as every arm does. The last line is for an arm
/// that something has pushed away. The correction that closes this part is the largest speed from which the joint can
/// brake to rest within the part (stopping_velocity() in model/velocity_range.h). The rate of the commanded position is
/// the commanded velocity plus the correction. This sum is clipped to the velocity limit and to the speed from which
/// the joint stops before its position limits; then to the change that the acceleration limit permits, which has
/// precedence. The commanded velocity itself is not altered. The stream catches up in HOLD and TRACK. In the other
/// modes the correction is 0; one that is under way ends within the acceleration limit.
struct CommandStream {
  bool running = false;
  JointVector position_rad;      ///< last commanded
  JointVector velocity_radps;    ///< last commanded
  JointVector rate_radps;        ///< rate of the last commanded position: velocity plus correction
  double braking_s = 0.0;        ///< for how long the range has been braking_range()
  double stopped_s = -HUGE_VAL;  ///< when the driver last stopped the arm because cycles paused

  /// No stream runs, or the last command was at rest.
  bool at_rest() const;
};

/// Ends a stream that the arm can no longer be following. There are three reasons: the cycles paused; after a silence
/// the arm is elsewhere; its driver has just started.
void check_continuity(const Model& model, const MonitorResult& inputs, CommandStream& stream);

/// The first state of a new stream: the position that the drives hold (else the measured one), and per joint the
/// reported velocity or the difference quotient of the measured positions (arm_rate_radps, n x 1), whichever is
/// smaller; 0 where their signs differ.
void start_stream(const Model& model, const ArmState& arm, const JointVector& arm_rate_radps, CommandStream& stream);

/// The range of the coming period: velocity_range() for a joint anywhere between commanded and measured position. The
/// commanded position is taken one correction ahead; the correction depends on the mode (see catching up above).
/// There is one more position limit: the velocity does not move the command farther than following_error_rad away from
/// the measured position. So the command of an arm that is held in place comes to rest.
VelocityRange next_range(const Model& model, Mode mode, const CommandStream& stream, const ArmState& arm);

/// The part of next_range() in which the arm comes to rest within bounded time: after 0.5 s the bound of every joint's
/// speed falls from its limit with half of its acceleration limit. Where nothing is near, the arm rests much earlier.
/// Within the bound a joint may also brake late, speed up or reverse, so that the shield can lead the arm past an
/// obstacle while it stops: if every joint braked as fast as it can, the arm could swing into one, or rest where one
/// comes through. Adds a period to stream.braking_s.
VelocityRange braking_range(const Model& model, const VelocityRange& range, CommandStream& stream);

/// The output gate: limits the velocity to the range, brakes if it is not finite, and integrates it to the commanded
/// position. Stores the command in the stream and sets the Limiting bits of the limits that acted.
Command gate(const Model& model, Mode mode, const ArmState& arm, const VelocityRange& range, JointVector velocity_radps,
             CommandStream& stream, int& limiting);

/// Whether the stream runs after this cycle. It runs in HOLD, TRACK and BRAKE, in FAULT until it is at rest, and not in
/// WAIT. A stream starts only with a fresh arm state that was received after stopped_s: an older one shows the arm
/// before its driver stopped it.
bool stream_continues(const CommandStream& stream, Mode mode, const MonitorResult& inputs);

/// A velocity within the limits: one uniform scale for the velocity limits, which keeps the direction, then each joint
/// clamped to its range (docs/paper.md, item 10). Returns the Limiting bits of the limits that acted.
int apply_limits(const JointLimits& limits, const VelocityRange& range, const JointVector& last_velocity_radps,
                 double period_s, JointVector& velocity_radps);

/// The velocity after one period of braking every joint at its acceleration limit; never past zero.
JointVector brake(const JointLimits& limits, const JointVector& last_velocity_radps, double period_s);

}  // namespace sidestep
