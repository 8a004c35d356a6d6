#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/sim/place.h"
#include "host/sim/plant.h"
#include "host/sim/sensing.h"
#include "host/sim/world.h"

namespace sidestep::sim {

struct RobotSource {
  std::string urdf_file;  ///< as found, see load_scenario
  std::string base;
  std::string tip;
  std::vector<std::string> package_path;  ///< of the controller's configuration
};

/// What must hold at the end of a run; what is absent is not judged.
struct Expectations {
  std::optional<double> final_distance_max_m;           ///< tool to target at the end
  std::optional<double> clearance_min_m;                ///< surface to surface
  std::optional<double> axis_distance_min_m;            ///< obstacle centre to arm axis
  std::optional<double> joint_speed_max_radps;          ///< measured
  std::optional<double> joint_acceleration_max_radps2;  ///< of the commands
};

/// Figures of the paper, carried for comparison.
struct Published {
  std::optional<double> final_distance_m;
  std::optional<double> axis_distance_m;
};

/// What one arm plays.
struct Scenario {
  std::string file;
  std::string arm;  ///< its name among several; empty for one alone
  std::string title;
  RobotSource robot;
  std::string controller_config;  ///< the configuration the controller is meant to have
  Channels channels;
  Eigen::Isometry3d world_from_base = Eigen::Isometry3d::Identity();
  int64_t period_us = 10'000;
  int periods = 0;  ///< the scenario runs from t = 0 to periods * period
  JointVector start_rad;
  PlantSpec plant;
  SensingSpec sensing;
  World world;  ///< at t = 0, base frame
  Expectations expect;
  Published published;

  double period_s() const { return static_cast<double>(period_us) / 1e6; }
  /// Time of the k-th control period.
  double time_s(int k) const { return static_cast<double>(k * period_us) / 1e6; }
  double duration_s() const { return time_s(periods); }
};

/// Reads a scenario: of one arm, in its base frame, or of several, `arms`, that share duration, obstacles and
/// expectations, in the world frame of their configurations. robot.urdf and config are looked for from the scenario's
/// folder upwards (firmware/base/find_file.h). Throws std::runtime_error, one line naming file and key, for anything
/// that is missing, unknown, of the wrong size, not finite or out of range.
std::vector<Scenario> load_scenario(const std::string& file);

}  // namespace sidestep::sim
