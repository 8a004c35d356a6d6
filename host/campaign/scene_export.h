#pragma once

#include "host/campaign/lwa3_arm.h"
#include "host/campaign/scene.h"

namespace sidestep::campaign {

/// The scene that `family:seed` denotes for an arm. Throws std::runtime_error.
Scene scene_to_export(const std::string& name, const JudgeArm& arm = lwa3_arm());

/// The scene as a YAML scenario of the simulator (host/scenarios). A motion that is not straight is given by waypoints.
std::string export_scene(const Scene& scene);

}  // namespace sidestep::campaign
