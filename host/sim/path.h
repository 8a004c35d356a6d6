#pragma once

#include <Eigen/Core>
#include <vector>

namespace sidestep::sim {

/// Where something is at one time, and how fast. Base frame.
struct Waypoint {
  double t_s = 0.0;
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_mps = Eigen::Vector3d::Zero();
};

/// At least one waypoint, times increasing.
using Path = std::vector<Waypoint>;

/// The path at time t_s: between two waypoints the cubic with their positions and velocities (Hermite), the velocity
/// being its derivative; before the first and after the last the velocity is constant.
Waypoint along(const Path& path, double t_s);

}  // namespace sidestep::sim
