#pragma once

#include "firmware/control/types/settings.h"
#include "firmware/model/clearance.h"

namespace sidestep {

/// Repulsive force of one obstacle on the tool, unit mass, m/s2, base frame. Paper eqs (9) and (10) as settled by
/// docs/paper.md, items 2 and 3: (10) uses the obstacle's velocity and acts only while the obstacle approaches.
Vector3 repulsion(const PaperGains& gains, const Vector3& obstacle_position_m, const Vector3& obstacle_velocity_mps,
                  const Vector3& tool_position_m, const Vector3& tool_velocity_mps);

/// Sum over all obstacles, extrapolated to the time of the cycle.
Vector3 repulsion(const PaperGains& gains, const ObstacleView& view, const Vector3& tool_position_m,
                  const Vector3& tool_velocity_mps);

}  // namespace sidestep
