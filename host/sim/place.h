#pragma once

#include <string>
#include <vector>

#include "host/sim/world.h"

namespace sidestep::sim {

/// LCM channels between one controller and the simulator.
struct Channels {
  std::string target = "TARGET";
  std::string obstacles = "OBSTACLES";
  std::string arm_state = "ARM_STATE";
  std::string arm_command = "ARM_COMMAND";
  std::string controller_status = "CONTROLLER_STATUS";
};

/// Where a controller's configuration says that its arm is: whom it speaks with, where its base stands among other
/// arms, what stands around it, base frame, and where the packages of its meshes are.
struct Place {
  Channels channels;
  Eigen::Isometry3d world_from_base = Eigen::Isometry3d::Identity();
  std::vector<Obstacle> surroundings;
  std::vector<std::string> package_path;
};

/// Reads these from a configuration, and nothing else of it. Throws std::runtime_error, one line naming file and key.
Place load_place(const std::string& config_file);

}  // namespace sidestep::sim
