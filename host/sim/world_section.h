#pragma once

#include <vector>

#include "firmware/io/config/yaml_section.h"
#include "host/sim/grasp.h"

namespace sidestep::sim {

/// The section `target` of a scenario.
Target read_target(YamlSection section);

/// The list `obstacles` of a scenario, then the parts of the persons of the optional list `people`: for each person a
/// capsule for each part of the body (host/people/body.h), in the order of BodyPart, with ids from the given one on.
std::vector<Obstacle> read_obstacles(YamlSection& scenario);

/// The list `grasp` of a scenario with these obstacles; empty when absent.
std::vector<GraspStep> read_grasp(YamlSection& scenario, const std::vector<Obstacle>& obstacles);

/// The list `surroundings` of a controller's configuration; empty when absent. Ids as in the controller's status.
std::vector<Obstacle> read_surroundings(YamlSection& config);

}  // namespace sidestep::sim
