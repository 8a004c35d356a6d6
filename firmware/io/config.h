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
  std::string loop_timing = "LOOP_TIMING";
};

/// Logs of the last seconds before a fault or a request; config section `blackbox:`.
struct BlackboxSettings {
  double seconds = 10.0;
  std::string folder = "blackbox";  ///< from the working directory; made when the first log is written
};

/// What the command line may say over the configuration; empty or zero: nothing.
struct Overrides {
  std::string law;
  std::string urdf;
  std::string base;
  std::string tip;
  double rate_hz = 0.0;
};

/// The arm's description; config section `robot:`.
struct Robot {
  std::string urdf;  ///< as found
  std::string base;
  std::string tip;
  MeshOptions meshes;
};

/// A configuration, complete and checked.
struct Config {
  Robot robot;
  Model model;
  Channels channels;
  BlackboxSettings blackbox;
  std::string file;  ///< what it was read from, with
  Overrides overrides;
};

/// Reads the YAML file (none when the name is empty: defaults, and the arm from the overrides) and the arm's URDF.
/// The URDF is looked for from the folder of the config file upwards, then from the working directory upwards.
/// Throws std::runtime_error with one line that names the file and the key; unknown keys are errors.
Config load_config(const std::string& file, const Overrides& overrides);

}  // namespace sidestep
