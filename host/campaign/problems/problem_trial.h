#pragma once

#include <atomic>
#include <limits>

#include "firmware/io/config/config.h"
#include "host/campaign/problems/problem_files.h"

namespace sidestep::campaign {

constexpr double kProblemDuration_s = 10.0;

/// How the controller did on a problem. The goal is the pose that the tool has in the goal posture.
struct ProblemResult {
  std::string kind, name;                 ///< of the problem
  double error_m = 0.0, error_rad = 0.0;  ///< of the tool at the end
  double arrival_s = 0.0;                 ///< since when the tool has been within 10 mm and 0.05 rad; the end: not yet
  double clearance_m = 0.0;               ///< the least one to the objects, by FCL on the URDF's shapes
  double self_clearance_m = 0.0;          ///< the least one between links (sim/self_distance.h), at most 0.02 m
  double mover_clearance_m = std::numeric_limits<double>::quiet_NaN();  ///< the least one to the mover, if it has one
  double guided = 0.0;  ///< the share of the time in which foresight had a guide

  bool arrived(double within_m) const { return error_m < within_m && error_rad < 0.05; }
  bool touched() const { return clearance_m <= 0.0 || self_clearance_m <= 0.0 || mover_clearance_m <= 0.0; }
};

/// Plays the problems for kProblemDuration_s each, from the first cycle that tracks, with an ideal plant. The objects
/// are reported to the controller as obstacles at rest, in every cycle, the mover with its velocity. The results are in
/// the order of the problems; when `stop` became true, those of the problems that were finished. Throws
/// std::runtime_error, one line.
std::vector<ProblemResult> play(const std::vector<Problem>& problems, const Config& config, int jobs, bool quiet,
                                const std::atomic<bool>& stop);

}  // namespace sidestep::campaign
