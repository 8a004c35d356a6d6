#pragma once

#include <vector>

#include "firmware/control/types/settings.h"
#include "firmware/model/arm.h"
#include "firmware/model/obstacle.h"

namespace sidestep {

/// Everything the controller knows that does not change while it runs.
struct Model {
  Arm arm;
  Settings settings;
  std::vector<SelfPair> self_pairs;
  std::vector<Obstacle> surroundings;  ///< static obstacles from the configuration file, base frame
};

}  // namespace sidestep
