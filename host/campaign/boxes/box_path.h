#pragma once

#include <vector>

#include "host/campaign/sphere_path.h"

namespace sidestep::campaign {

/// The path of a box's centre: to and fro on a straight line at constant speed. At both ends of the line the velocity
/// reverses. Before t = 0 the position is the start.
class BoxPath {
 public:
  /// velocity_mps: at the start, may be 0. ahead_m, behind_m: from the start to the ends of the line, along the
  /// velocity and against it; their sum is positive.
  BoxPath(const Vector3& start_m, const Vector3& velocity_mps, double ahead_m, double behind_m);

  PointMotion at(double t_s) const;

  /// The times until until_s at which the velocity reverses.
  std::vector<double> turns_s(double until_s) const;

 private:
  Vector3 start_m_, velocity_mps_;
  double speed_mps_, ahead_m_, behind_m_;
};

}  // namespace sidestep::campaign
