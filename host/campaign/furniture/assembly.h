#pragma once

#include <vector>

#include "host/sim/world.h"

namespace sidestep::campaign {

/// Collects the boxes and cylinders of a piece of furniture in its own frame: origin at the goal of the tool, z up, x
/// horizontally into the furniture, away from the arm.
class Assembly {
 public:
  /// yaw_rad: of x, base frame.
  Assembly(const Eigen::Vector3d& origin_m, double yaw_rad)
      : base_from_furniture_(Eigen::Translation3d(origin_m) * Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ())) {}

  /// A box between two opposite corners, each coordinate of the first below that of the second.
  void add_box(const Eigen::Vector3d& low_m, const Eigen::Vector3d& high_m);

  /// A cylinder that stands on this point.
  void add_can(const Eigen::Vector3d& foot_m, double radius_m, double height_m);

  /// Base frame, ids from 0.
  const std::vector<sim::Obstacle>& solids() const { return solids_; }

 private:
  void add(sim::Shape shape, const Eigen::Vector3d& size_m, const Eigen::Vector3d& centre_m);

  Eigen::Isometry3d base_from_furniture_;
  std::vector<sim::Obstacle> solids_;
};

}  // namespace sidestep::campaign
