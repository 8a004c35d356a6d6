#pragma once

#include <Eigen/Core>
#include <vector>

namespace sidestep {

struct Circle {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double radius_m = 0.0;
};

/// The smallest circle around points of a plane, m (E. Welzl, Smallest enclosing disks, 1991, without recursion). Every
/// point is inside up to rounding. No points: radius 0 at the origin.
Circle circle_around(std::vector<Eigen::Vector2d> points_m);

}  // namespace sidestep
