#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "firmware/model/capsule.h"

namespace sidestep {

/// A capsule and the velocities of the ends of its axis, base frame.
struct CapsuleMotion {
  Capsule capsule;
  Vector3 start_mps, end_mps;

  Vector3 centre_mps() const { return 0.5 * (start_mps + end_mps); }
  /// Of the axis; the capsule does not turn about its axis.
  Vector3 angular_radps() const;
};

/// The path of a capsule: each end of its axis follows a cubic spline through samples at a constant period. Before t =
/// 0 and after the last sample it stays there.
class CapsulePath {
 public:
  struct Ends {
    Vector3 start_m, end_m;
  };

  /// At least two samples, the first at t = 0.
  CapsulePath(double radius_m, double period_s, std::vector<Ends> samples);

  CapsuleMotion at(double t_s) const;

  /// The same path, given in frame a, in frame b; the frames do not move against each other.
  CapsulePath transformed(const Eigen::Isometry3d& b_from_a) const;

 private:
  /// Velocities of the ends at a sample: central differences.
  Ends slope_mps(size_t sample) const;

  double radius_m_, period_s_;
  std::vector<Ends> samples_;
};

}  // namespace sidestep
