#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host/sim/arm_setup.h"
#include "host/sim/grasp.h"
#include "host/sim/plant.h"
#include "host/sim/sensing.h"
#include "host/sim/world.h"

namespace sidestep::sim {

struct RobotSource {
  std::string urdf_file;  ///< path of the file that was found, see load_scenario
  std::string base;
  std::string tip;
  std::vector<std::string> package_path;          ///< from the controller's configuration
  std::map<std::string, double> joint_positions;  ///< from there, too
};

/// Bounds that must hold over a run; an absent one is not checked.
struct Expectations {
  std::optional<double> final_distance_max_m;           ///< tool to target at the end
  std::optional<double> clearance_min_m;                ///< surface to surface
  std::optional<double> axis_distance_min_m;            ///< obstacle centre to arm axis
  std::optional<double> joint_speed_max_radps;          ///< measured
  std::optional<double> joint_acceleration_max_radps2;  ///< of the commands
};

/// Figures of the paper, printed for comparison.
struct Published {
  std::optional<double> final_distance_m;
  std::optional<double> axis_distance_m;
};

/// The scenario of one arm.
struct Scenario {
  std::string file;
  std::string arm;  ///< name among several arms; empty for a single one
  std::string title;
  RobotSource robot;
  std::string controller_config;  ///< configuration file of the controller
  Channels channels;
  Eigen::Isometry3d world_from_base = Eigen::Isometry3d::Identity();
  int64_t period_us = 10'000;
  int periods = 0;  ///< the scenario runs from t = 0 to periods * period; 0: without end
  JointVector start_rad;
  PlantSpec plant;
  SensingSpec sensing;
  World world;  ///< at t = 0, base frame
  std::vector<GraspStep> grasp;
  Expectations expect;
  Published published;

  double period_s() const { return static_cast<double>(period_us) / 1e6; }
  /// Time of the k-th control period.
  double time_s(int k) const { return static_cast<double>(k * period_us) / 1e6; }
  bool endless() const { return periods == 0; }
  double duration_s() const { return time_s(periods); }  ///< 0 when endless
};

/// Reads a scenario file and returns one scenario per arm. The file of a single arm is in its base frame. In a file
/// with the list `arms`, the arms share duration, obstacles and expectations, in the world frame of their
/// configurations. Optional are: `duration_s`, without it the scenario runs until it is interrupted; `target` and
/// `obstacles`, without them other processes send TARGET and OBSTACLES (see SimWire::leave_to_others). The files
/// robot.urdf and config are searched from the scenario's folder upwards (firmware/base/find_file.h). Throws
/// std::runtime_error, one line that names file and key, when a value is missing, unknown, of the wrong size, not
/// finite or out of range.
std::vector<Scenario> load_scenario(const std::string& file);

}  // namespace sidestep::sim
