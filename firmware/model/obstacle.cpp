#include "firmware/model/obstacle.h"

namespace sidestep {

Obstacle transformed(const Eigen::Isometry3d& b_from_a, const Obstacle& obstacle) {
  const Capsule& capsule = obstacle.capsule;
  return {obstacle.id,
          {b_from_a * capsule.start, b_from_a * capsule.end, capsule.radius_m},
          b_from_a.linear() * obstacle.velocity_mps,
          b_from_a.linear() * obstacle.angular_velocity_radps};
}

Capsule moved(const Obstacle& obstacle, double dt_s) {
  const Capsule& capsule = obstacle.capsule;
  const Vector3 shift = obstacle.velocity_mps * dt_s;
  const Vector3 turn = obstacle.angular_velocity_radps * dt_s;
  if (capsule.start == capsule.end || turn.squaredNorm() == 0.0)
    return {capsule.start + shift, capsule.end + shift, capsule.radius_m};
  const Matrix3 rotation = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  const Vector3 centre = 0.5 * (capsule.start + capsule.end);
  const Vector3 half = rotation * (capsule.end - centre);
  return {centre - half + shift, centre + half + shift, capsule.radius_m};
}

}  // namespace sidestep
