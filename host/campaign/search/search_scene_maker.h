#pragma once

#include "host/campaign/random.h"
#include "host/campaign/search/search_scene.h"

namespace sidestep::campaign {

/// What the scenes of one search have in common.
struct SearchSpace {
  SearchFamily family;
  int obstacles;       ///< of every scene
  double fastest_mps;  ///< largest speed of an obstacle
  Limits limits;       ///< of the joints
};

/// A random valid scene. The centre of every obstacle crosses the axis of a moving link of the arm at its start. Throws
/// std::runtime_error if none is found.
SearchScene draw_search_scene(Random& random, const SearchSpace& space);

/// A valid scene that differs a little from the given one: in the lines, speeds, times and sizes of some obstacles and
/// perhaps in the start.
SearchScene mutated(Random& random, const SearchSpace& space, const SearchScene& scene);

}  // namespace sidestep::campaign
