#pragma once

#include <vector>

#include "firmware/io/config/yaml_geometry.h"
#include "firmware/model/obstacle.h"

namespace sidestep {

/// The list `surroundings` of a configuration as obstacles at rest, base frame.
std::vector<Obstacle> read_surroundings(YamlSection& config);

}  // namespace sidestep
