#pragma once

#include <vector>

#include "host/sim/fields.h"
#include "host/sim/world.h"

namespace sidestep::sim {

/// As a scenario says where things are; what is wrong is said as by Fields.
Target read_target(Fields fields);

/// The list `obstacles`.
std::vector<Obstacle> read_obstacles(Fields& scenario);

/// The list `surroundings` of a controller's configuration, empty when absent. Ids as in the controller's status.
std::vector<Obstacle> read_surroundings(Fields& config);

}  // namespace sidestep::sim
