#include "tests/bench/bare.h"

#include <algorithm>
#include <cmath>

namespace sidestep::bench {
namespace {

double nearest_sphere_m(const Arm& arm, const Posture& posture, const ObstacleSet& spheres) {
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const LinkShape& shape : arm.shapes) {
    if (shape.body == 0) continue;
    const Capsule link = placed(posture, shape);
    const Vector3 axis = link.end - link.start;
    const double inverse_length2 = axis.squaredNorm() > 0.0 ? 1.0 / axis.squaredNorm() : 0.0;
    for (int o = 0; o < spheres.count; ++o) {
      const Capsule& sphere = spheres.obstacles[static_cast<size_t>(o)].capsule;
      const Vector3 to_sphere = sphere.start - link.start;
      const double along = std::clamp(axis.dot(to_sphere) * inverse_length2, 0.0, 1.0);
      const double distance_m = (to_sphere - along * axis).norm() - link.radius_m - sphere.radius_m;
      nearest_m = std::min(nearest_m, distance_m);
    }
  }
  return nearest_m;
}

}  // namespace

Bare bare_cycle(const Arm& arm, const JointVector& q_rad, const ObstacleSet& spheres, const Vector3& target_m) {
  const double gain_per_s = 8.0, damping2 = 0.05 * 0.05;
  const Posture posture = forward(arm, q_rad);
  const PointJacobian jacobian = point_jacobian(posture, arm.joints, posture.tool_position);
  const Matrix3 gram = jacobian * jacobian.transpose() + damping2 * Matrix3::Identity();
  const Vector3 wish_mps = gain_per_s * (target_m - posture.tool_position);
  return {jacobian.transpose() * gram.ldlt().solve(wish_mps), nearest_sphere_m(arm, posture, spheres)};
}

}  // namespace sidestep::bench
