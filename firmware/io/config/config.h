#pragma once

#include <string>
#include <vector>

#include "firmware/control/cycle.h"
#include "firmware/io/lcm/dialect.h"

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

constexpr size_t kMaxNeighbours = 16;

/// Other arms in the same workspace; config section `neighbours:`. Links are told in one world frame.
struct Neighbours {
  std::string publish;              ///< channel for our own links; empty: they are not told
  std::vector<std::string> listen;  ///< channels of the others' links
  Eigen::Isometry3d world_from_base = Eigen::Isometry3d::Identity();
};

/// Logs of the last seconds before a fault or a request; config section `blackbox:`.
struct BlackboxSettings {
  double seconds = 10.0;
  std::string folder = "blackbox";  ///< relative to the working directory; created with the first log
};

/// Options of the command line that replace values of the configuration; empty or zero: not given.
struct Overrides {
  std::string law;
  std::string urdf;
  std::string base;
  std::string tip;
  double rate_hz = 0.0;
};

/// The arm's description; config section `robot:`.
struct Robot {
  std::string urdf;  ///< path of the file that was found
  std::string base;
  std::string tip;
  MeshOptions meshes;
};

/// A complete and checked configuration.
struct Config {
  Robot robot;
  Model model;
  Dialect dialect = Dialect::kSidestep;
  Channels channels;
  Neighbours neighbours;
  BlackboxSettings blackbox;
  std::string file;  ///< this file and the overrides are its source
  Overrides overrides;
};

/// Reads the YAML file and the arm's URDF, which is searched from the folder of the YAML file upwards (find_file.h).
/// Without a file (empty name) all settings are the defaults and the arm comes from the overrides.
/// Throws std::runtime_error with one line that names the file and the key; unknown keys are errors.
Config load_config(const std::string& file, const Overrides& overrides);

}  // namespace sidestep
