#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "host/sim/path.h"
#include "host/sim/solid.h"

namespace sidestep::sim {

/// Pose of something that moves with constant velocities or, given a path, along it while it turns at a constant rate.
/// Base frame, m, m/s, rad/s.
struct Motion {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d velocity_mps = Eigen::Vector3d::Zero();
  Eigen::Vector3d angular_velocity_radps = Eigen::Vector3d::Zero();
  std::shared_ptr<const Path> path;  ///< or null; shared by all copies
  double path_s = 0.0;               ///< the present time on the path

  Eigen::Isometry3d base_from_body() const { return Eigen::Translation3d(position_m) * orientation; }
};

struct Obstacle {
  int32_t id = 0;
  Solid solid;
  Motion motion;
};

struct Target {
  Motion motion;
  bool tracks_orientation = false;
};

/// All that the arm reaches for and keeps clear of, at one instant.
struct World {
  Target target;
  std::vector<Obstacle> obstacles;
  std::vector<Obstacle> surroundings;  ///< at rest; the controller knows them, nobody tells it

  /// Obstacles, then surroundings.
  std::vector<Obstacle> all() const;
};

/// The world dt_s later: positions on their paths or straight on; the orientation follows the constant angular velocity
/// exactly.
World later(const World& now, double dt_s);

/// The same with target and obstacles in another frame, at rest against theirs.
World seen_from(const Eigen::Isometry3d& there_from_here, const World& world);

}  // namespace sidestep::sim
