#pragma once

#include "firmware/control/cycle.h"

namespace sidestep {

/// The obstacles as they are now: the last set and its age. They grow by what is not known: where they were, how they
/// have moved since, and past the time of the set by as far as they may have come. The surroundings do not.
ObstacleView view_obstacles(const Model& model, const Latest<ObstacleSet>& obstacles, double now_s);

/// The target dt_s later at its own velocities.
Target extrapolated(const Target& target, double dt_s);

/// The target moved forward from its receipt to the present. There is one.
Target extrapolated(const Latest<Target>& latest, double now_s);

}  // namespace sidestep
