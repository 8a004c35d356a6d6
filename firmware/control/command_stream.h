#pragma once

#include <cmath>

#include "firmware/control/input_monitor.h"
#include "firmware/control/types/inputs.h"
#include "firmware/control/types/model.h"
#include "firmware/model/velocity_range.h"

namespace sidestep {

/// The stream of commands to the arm: started from the measured arm, continued from its own last command, ended at rest
/// or when the arm can no longer be following it.
///
/// Catching up. The commanded position normally moves with the commanded velocity. Where the arm lags behind or was
/// pushed, its following error (measured - commanded position) is reduced in addition: by the part beyond half of
/// Settings::following_error_rad, and completely once the error exceeds following_error_rad. The correction keeps the
/// joints' velocity and acceleration limits. Then the rate of the commanded position differs from the velocity.
struct CommandStream {
  bool running = false;
  JointVector position_rad;      ///< last commanded
  JointVector velocity_radps;    ///< last commanded
  JointVector rate_radps;        ///< rate of the last commanded position: velocity plus correction
  double stopped_s = -HUGE_VAL;  ///< when the arm last stopped because no command reached it in time

  /// No stream runs, or the last command was at rest.
  bool at_rest() const;
};

/// Ends a stream that the arm can no longer be following: after a pause of the cycles, when the measured arm could not
/// have come from the last command, or when the driver has just started.
void check_continuity(const Model& model, const MonitorResult& inputs, CommandStream& stream);

/// The first state of a new stream: at the position that the drives hold (else the measured one), with the velocity on
/// which the reported one and the differentiated positions agree. arm_rate_radps: those differences, n x 1.
void start_stream(const Model& model, const ArmState& arm, const JointVector& arm_rate_radps, CommandStream& stream);

/// Joint velocities allowed for the coming period, by all joint limits and the following error, for any arm position
/// between commanded and measured.
VelocityRange next_range(const Model& model, Mode mode, const CommandStream& stream, const ArmState& arm);

/// The output gate: limits the velocity to the range, or brakes in modes that do not move, and integrates it to the
/// commanded position. Stores the command in the stream and sets the Limiting bits of the limits that acted.
Command gate(const Model& model, Mode mode, const ArmState& arm, const VelocityRange& range, JointVector velocity_radps,
             CommandStream& stream, int& limiting);

/// Whether commands are sent: the arm is followed by fresh states, and the mode commands it. In mode FAULT the stream
/// runs until it is at rest.
bool stream_continues(const CommandStream& stream, Mode mode, const MonitorResult& inputs);

/// A velocity within the limits: one uniform scale for the velocity limits, which keeps the direction, then each joint
/// clamped to its range (docs/paper.md, item 10). Returns the Limiting bits of the limits that acted.
int apply_limits(const JointLimits& limits, const VelocityRange& range, const JointVector& last_velocity_radps,
                 double period_s, JointVector& velocity_radps);

/// The velocity after one period of braking every joint at its acceleration limit; never past zero.
JointVector brake(const JointLimits& limits, const JointVector& last_velocity_radps, double period_s);

}  // namespace sidestep
