#pragma once

#include <vector>

#include "firmware/io/config/config_section.h"
#include "firmware/model/obstacle.h"

namespace sidestep {

constexpr int kMaxSurroundings = 256;

/// What always stands around the arm, at rest in the base frame: the list `surroundings:` of a configuration, in the
/// words of a scenario's obstacles. Their ids go down from -2, which no status uses for anything else.
std::vector<Obstacle> read_surroundings(Section& config);

}  // namespace sidestep
