#pragma once

#include "firmware/control/types/inputs.h"
#include "firmware/control/types/model.h"
#include "firmware/model/clearance.h"

namespace sidestep {

/// The newest obstacle set, its age and its growth, together with the surroundings. Reported obstacles grow by their
/// position uncertainty plus, with a the acceleration bound, v the speed bound and t the age including the latency:
///   while the set is fresh   min(1/2 a t^2, v t)
///   after its timeout        v t
/// Surroundings do not grow.
ObstacleView view_obstacles(const Model& model, const Latest<ObstacleSet>& obstacles, double now_s);

/// The target dt_s later, at its own linear and angular velocity.
Target extrapolated(const Target& target, double dt_s);

/// The newest target, extrapolated from its receipt to now_s. There must be one.
Target extrapolated(const Latest<Target>& latest, double now_s);

}  // namespace sidestep
