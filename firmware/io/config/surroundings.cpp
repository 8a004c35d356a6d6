#include "firmware/io/config/surroundings.h"

namespace sidestep {
namespace {

Obstacle obstacle_of(const RestingShape& entry) {
  const Vector3& size_m = entry.shape.size_m;
  const Matrix3 base_from_shape = entry.orientation.toRotationMatrix();
  switch (entry.shape.kind) {
    case ShapeKind::kCapsule:
      return capsule_obstacle(entry.position_m, base_from_shape, size_m[0], size_m[1]);
    case ShapeKind::kCylinder:
      return cylinder_obstacle(entry.position_m, base_from_shape, size_m[0], size_m[1]);
    case ShapeKind::kBox:
      return box_obstacle(entry.position_m, base_from_shape, size_m);
    case ShapeKind::kSphere:
      break;
  }
  return sphere_obstacle(entry.position_m, size_m[0]);
}

}  // namespace

std::vector<Obstacle> read_surroundings(YamlSection& config) {
  std::vector<Obstacle> surroundings;
  for (const RestingShape& entry : read_resting_shapes(config)) {
    surroundings.push_back(obstacle_of(entry));
    surroundings.back().id = entry.id;
  }
  return surroundings;
}

}  // namespace sidestep
