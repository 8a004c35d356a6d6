#include "firmware/model/link_obstacle.h"

namespace sidestep {

Obstacle link_obstacle(const LinkPoses& poses, const BodyShape& shape, const JointVector& velocity_radps) {
  Obstacle link;
  link.shape = Shape::kCapsule;
  link.capsule = transformed(poses, shape);
  const Vector3 centre = 0.5 * (link.capsule.start + link.capsule.end);
  link.velocity_mps = point_velocity(poses, shape.body, centre, velocity_radps);
  for (int joint = 1; joint <= shape.body; ++joint) {
    if (poses.prismatic[joint - 1]) continue;
    link.angular_velocity_radps += poses.rotation[static_cast<size_t>(joint)].col(2) * velocity_radps[joint - 1];
  }
  return link;
}

}  // namespace sidestep
