#pragma once

#include "firmware/model/obstacle.h"
#include "host/sim/truth.h"

namespace sidestep::campaign {

/// A box, cylinder or sphere that does not turn, as the controller receives it. Its id is not set.
Obstacle reported(const sim::Obstacle& solid);

/// A capsule at rest for the simulator's distances.
sim::Obstacle capsule_obstacle(const Capsule& capsule);

}  // namespace sidestep::campaign
