#pragma once

#include "host/campaign/scene.h"

namespace sidestep::campaign {

/// The scene that `family:seed` names. Throws std::runtime_error.
Scene scene_named(const std::string& name);

/// The scene as a scenario of the simulator (host/scenarios), YAML. What moves on a curve is given by waypoints.
std::string scenario_yaml(const Scene& scene);

}  // namespace sidestep::campaign
