#pragma once

#include "host/campaign/lwa3_arm.h"
#include "host/campaign/scene.h"

namespace sidestep::campaign {

/// The scene that `family:seed` names for an arm. Throws std::runtime_error.
Scene scene_named(const std::string& name, const JudgeArm& arm = lwa3_arm());

/// The scene as a scenario of the simulator (host/scenarios), YAML. What moves on a curve is given by waypoints.
std::string scenario_yaml(const Scene& scene);

}  // namespace sidestep::campaign
