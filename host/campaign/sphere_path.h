#pragma once

#include <Eigen/Core>
#include <vector>

namespace sidestep::campaign {

using Vector3 = Eigen::Vector3d;

struct Moving {
  Vector3 position_m;
  Vector3 velocity_mps;
};

/// Where a sphere is over time. Between two knots its velocity goes smoothly (minimum jerk) from one to the other's;
/// after the last it is constant; before t = 0 the sphere stands at its start.
class SpherePath {
 public:
  SpherePath(const Vector3& start_m, const Vector3& velocity_mps) : knots_{{0.0, start_m, velocity_mps}} {}

  /// From the last knot on: reach the velocity `duration_s` later.
  void then(double duration_s, const Vector3& velocity_mps);

  Moving at(double t_s) const;
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
