#pragma once

#include "firmware/control/types/settings.h"
#include "firmware/model/clearance.h"

namespace sidestep {

/// Force of one obstacle on the tool, unit mass, m/s2, base frame. Paper eqs (9) and (10) as paper-notes items 2 and 3
/// settle them: (10) with the obstacle's velocity, and only while the obstacle approaches.
Vector3 repulsion(const PaperGains& gains, const Vector3& obstacle_position_m, const Vector3& obstacle_velocity_mps,
                  const Vector3& tool_position_m, const Vector3& tool_velocity_mps);

/// Sum over all obstacles, moved forward to the present.
Vector3 repulsion(const PaperGains& gains, const ObstacleView& view, const Vector3& tool_position_m,
                  const Vector3& tool_velocity_mps);

}  // namespace sidestep
