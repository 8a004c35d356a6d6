#pragma once

#include <string>

#include "firmware/control/cycle.h"

namespace sidestep {

/// LCM channel names; config section `channels:`.
struct Channels {
  std::string target = "TARGET";
  std::string obstacles = "OBSTACLES";
  std::string arm_state = "ARM_STATE";
  std::string arm_command = "ARM_COMMAND";
  std::string controller_status = "CONTROLLER_STATUS";
};

/// What the command line may say over the configuration; empty: nothing.
struct Overrides {
  std::string law;
  std::string urdf;
  std::string base;
  std::string tip;
};

/// A configuration, complete and checked.
struct Config {
  Model model;
  Channels channels;
};

/// Reads the YAML file (none when the name is empty: defaults, and the arm from the overrides) and the arm's URDF.
/// The URDF is looked for from the folder of the config file upwards, then from the working directory upwards.
/// Throws std::runtime_error with one line that names the file and the key; unknown keys are errors.
Config load_config(const std::string& file, const Overrides& overrides);

}  // namespace sidestep
