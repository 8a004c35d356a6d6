#pragma once

#include <Eigen/Core>
#include <vector>

namespace sidestep::campaign {

using Vector3 = Eigen::Vector3d;

/// Position and velocity of a point, base frame.
struct PointMotion {
  Vector3 position_m;
  Vector3 velocity_mps;
};

/// The path of a sphere's centre. Between two knots the velocity blends smoothly (minimum jerk); after the last knot it
/// is constant; before t = 0 the position is the start.
class SpherePath {
 public:
  SpherePath(const Vector3& start_m, const Vector3& velocity_mps) : knots_{{0.0, start_m, velocity_mps}} {}

  /// Adds a knot at which the sphere has this velocity, duration_s after the last knot.
  void add_knot(double duration_s, const Vector3& velocity_mps);

  PointMotion at(double t_s) const;
  double last_knot_s() const { return knots_.back().t_s; }
  bool straight() const { return knots_.size() == 1; }

 private:
  struct Knot {
    double t_s;
    Vector3 position_m;
    Vector3 velocity_mps;
  };

  std::vector<Knot> knots_;
};

}  // namespace sidestep::campaign
