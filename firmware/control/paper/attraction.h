#pragma once

#include "firmware/control/types/messages.h"
#include "firmware/control/types/settings.h"

namespace sidestep {

/// Attractive force of the target on the tool, unit mass, m/s2, base frame. Paper eqs (7) and (8); the norms of (7)
/// cancel.
Vector3 attraction(const PaperGains& gains, const Target& target, const Vector3& tool_position_m,
                   const Vector3& tool_velocity_mps);

/// Angular velocity that turns the tool to the target's orientation, rad/s, base frame (docs/paper.md, k_ori_per_s).
Vector3 orientation_rate(const PaperGains& gains, const Target& target, const Matrix3& base_from_tool);

}  // namespace sidestep
