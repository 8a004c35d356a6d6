#pragma once

#include <string>
#include <vector>

#include "firmware/control/cycle.h"
#include "firmware/io/lcm/channels.h"
#include "firmware/io/lcm/dialect.h"
#include "firmware/io/lcm/wire.h"
#include "firmware/model/load/load_arm.h"
#include "firmware/model/load/self_pairs.h"

namespace sidestep {

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
  JointPositions joint_positions;  ///< of joints that are no part of the chain
  std::string srdf;                ///< path of the file that was found; empty: none
  std::vector<LinkPair> ignored_pairs;
};

/// A complete and checked configuration.
struct Config {
  Robot robot;
  Model model;
  const Dialect* dialect = &kSidestepDialect;
  Channels channels;
  Neighbours neighbours;
  BlackboxSettings blackbox;
  std::string file;     ///< the YAML file that it was read from; empty without one
  Overrides overrides;  ///< of the command line, included above

  /// One sentence for each value that takes a protection away and may have a reason in an experiment, and for each
  /// joint outside the chain whose position is not given.
  std::vector<std::string> warnings;

  /// What the wire needs of it. The configuration outlives the wire.
  WireSetup wire() const { return {channels, neighbours, *dialect, model.arm}; }
};

/// Reads the YAML file and the arm's URDF, which is searched from the folder of the YAML file upwards (find_file.h).
/// Without a file (empty name) all settings are the defaults and the arm comes from the overrides.
/// Throws std::runtime_error with one line that names the file and the key; unknown keys are errors.
Config load_config(const std::string& file, const Overrides& overrides);

}  // namespace sidestep
