#pragma once

#include <fstream>
#include <string>

#include "host/sim/controller_message.h"
#include "host/sim/scenario.h"
#include "host/sim/truth.h"

namespace sidestep::sim {

/// Links farther apart are not measured: the search for contact costs little then, also between meshes.
constexpr double kSelfRange_m = 0.05;

/// The state at the start of one control period.
struct Row {
  std::string arm;  ///< name among several arms
  double t_s = 0.0;
  JointVector q_rad, qd_radps;  ///< measured
  JointVector command_radps;    ///< for the coming period
  Status status;
  World world;
  Eigen::Vector3d tool_m = Eigen::Vector3d::Zero();
  double target_distance_m = 0.0;  ///< NaN without a target
  Nearest nearest;
  double axis_distance_m = kNothingNear;
  double neighbour_m = kNothingNear;  ///< clearance to the links of other arms
  NearestLinks nearest_links;         ///< of this arm, those closer than kSelfRange_m
};

/// Computes the tool position and the distances of the row. The truth must be in the configuration of the row.
void evaluate(Row& row, const Truth& truth);

/// One line per control period: time, joints, tool, target, distances, obstacles, controller, other arms, the arm's own
/// links (self_clearance_m: inf from kSelfRange_m on); 17 significant digits.
/// The columns are named in the first line. cycle_time_s is the only one that differs between two equal lockstep runs.
class CsvFile {
 public:
  /// Throws std::runtime_error when the file cannot be written.
  CsvFile(const std::string& file, int joints, int obstacles);

  /// The truth must be in the configuration of the row.
  void write(const Row& row, const Truth& truth);

  /// Throws std::runtime_error when something could not be written.
  void close();

 private:
  std::string file_;
  std::ofstream out_;
};

}  // namespace sidestep::sim
