#pragma once

#include <string>
#include <vector>

#include "firmware/control/cycle.h"
#include "firmware/io/lcm/channels.h"
#include "firmware/io/lcm/dialect.h"
#include "firmware/io/lcm/wire.h"

namespace sidestep {

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
  const Dialect* dialect = &kSidestepDialect;
  Channels channels;
  Neighbours neighbours;
  BlackboxSettings blackbox;
  std::string file;     ///< the YAML file that it was read from; empty without one
  Overrides overrides;  ///< of the command line, included above

  /// What the wire needs of it. The configuration outlives the wire.
  WireSetup wire() const { return {channels, neighbours, *dialect, model.arm}; }
};

/// Reads the YAML file (none when the name is empty: defaults, and the arm from the overrides) and the arm's URDF.
/// The URDF is looked for from the folder of the config file upwards (find_file.h).
/// Throws std::runtime_error with one line that names the file and the key; unknown keys are errors.
Config load_config(const std::string& file, const Overrides& overrides);

}  // namespace sidestep
