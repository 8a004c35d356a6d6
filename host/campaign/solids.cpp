#include "host/campaign/solids.h"

namespace sidestep::campaign {

namespace {

Obstacle at_rest(const sim::Obstacle& solid) {
  const Vector3 &position = solid.motion.position_m, &size = solid.solid.size_m;
  const Matrix3 rotation = solid.motion.orientation.toRotationMatrix();
  if (solid.solid.shape == sim::Shape::kBox) return box_obstacle(position, rotation, size);
  if (solid.solid.shape == sim::Shape::kCylinder) return cylinder_obstacle(position, rotation, size.x(), size.y());
  return sphere_obstacle(position, size.x());
}

}  // namespace

Obstacle reported(const sim::Obstacle& solid) {
  Obstacle obstacle = at_rest(solid);
  obstacle.velocity_mps = solid.motion.velocity_mps;
  return obstacle;
}

sim::Obstacle capsule_obstacle(const Capsule& capsule) {
  const Vector3 axis_m = capsule.end - capsule.start;
  sim::Obstacle obstacle;
  obstacle.solid.shape = sim::Shape::kCapsule;
  obstacle.solid.size_m = {capsule.radius_m, axis_m.norm(), 0.0};
  obstacle.motion.position_m = capsule.centre();
  obstacle.motion.orientation = Eigen::Quaterniond::FromTwoVectors(Vector3::UnitZ(), axis_m);
  return obstacle;
}

}  // namespace sidestep::campaign
