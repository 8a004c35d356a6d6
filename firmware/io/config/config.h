#pragma once

#include <string>
#include <vector>

#include "firmware/control/cycle.h"
#include "firmware/io/lcm/dialect.h"
#include "firmware/model/load/load_arm.h"

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
  Dialect dialect = Dialect::kSidestep;
  Channels channels;
  Neighbours neighbours;
  BlackboxSettings blackbox;
  std::string file;  ///< what it was read from, with
  Overrides overrides;
};

/// Reads the YAML file (none when the name is empty: defaults, and the arm from the overrides) and the arm's URDF.
/// The URDF is looked for from the folder of the config file upwards (find_file.h).
/// Throws std::runtime_error with one line that names the file and the key; unknown keys are errors.
Config load_config(const std::string& file, const Overrides& overrides);

}  // namespace sidestep
