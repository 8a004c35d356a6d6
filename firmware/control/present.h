#pragma once

#include "firmware/control/inputs.h"
#include "firmware/model/clearance.h"

namespace sidestep {

/// The obstacles as they are now: the last set and its age; past its time it grows by what may have happened since.
ObstacleView view_obstacles(const Settings& settings, const Latest<ObstacleSet>& obstacles, double now_s);

/// The target dt_s later at its own velocities.
Target moved_on(const Target& target, double dt_s);

/// The target moved forward from its receipt to the present. There is one.
Target present(const Latest<Target>& latest, double now_s);

}  // namespace sidestep
