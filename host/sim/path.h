#pragma once

#include <Eigen/Core>
#include <vector>

namespace sidestep::sim {

/// Position and velocity at one time, base frame.
struct Waypoint {
  double t_s = 0.0;
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_mps = Eigen::Vector3d::Zero();
};

/// At least one waypoint, times increasing.
using Path = std::vector<Waypoint>;

/// Position and velocity at time t_s. Between two waypoints: the cubic with their positions and velocities (Hermite)
/// and its derivative. Before the first and after the last waypoint the velocity is constant.
Waypoint waypoint_at(const Path& path, double t_s);

}  // namespace sidestep::sim
