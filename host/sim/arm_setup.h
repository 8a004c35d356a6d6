#pragma once

#include <map>
#include <string>
#include <vector>

#include "firmware/io/lcm/channels.h"
#include "host/sim/world.h"

namespace sidestep::sim {

/// The part of a controller's configuration that the simulator needs.
struct ArmSetup {
  Channels channels;
  Eigen::Isometry3d world_from_base = Eigen::Isometry3d::Identity();  ///< world: common frame of several arms
  std::vector<Obstacle> surroundings;                                 ///< at rest, base frame
  std::vector<std::string> package_path;                              ///< folders with the packages of meshes
  std::map<std::string, double> joint_positions;                      ///< of joints that are no part of the chain
};

/// Reads the configuration; keys that the simulator does not need are ignored.
/// Throws std::runtime_error, one line that names file and key.
ArmSetup load_arm_setup(const std::string& config_file);

}  // namespace sidestep::sim
