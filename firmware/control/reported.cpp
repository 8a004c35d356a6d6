#include "firmware/control/reported.h"

#include <cmath>

namespace sidestep {

Obstacle reported_obstacle(Shape shape, const Vector3& centre, const Quaternion& turn, const Vector3& size_m) {
  if (shape == Shape::kSphere) return sphere_obstacle(centre, size_m.allFinite() ? size_m[0] : std::nan(""));
  const bool sized = size_m.allFinite() && size_m.minCoeff() >= 0.0, rotated = std::abs(turn.norm() - 1.0) < 1e-3;
  const Matrix3 rotation = turn.normalized().toRotationMatrix();
  if (sized && rotated && shape == Shape::kCapsule) return capsule_obstacle(centre, rotation, size_m[0], size_m[1]);
  if (sized && rotated && shape == Shape::kBox) return box_obstacle(centre, rotation, size_m);
  return sphere_obstacle(centre, std::nan(""));
}

bool complete(Target& target) {
  if (!plausible(target)) return false;
  target.orientation = target.tracks_orientation ? target.orientation.normalized() : Quaternion::Identity();
  if (!target.tracks_orientation) target.angular_velocity_radps.setZero();
  return true;
}

bool complete(Shape shape, Obstacle& obstacle) {
  if (!plausible(obstacle)) return false;
  if (shape == Shape::kSphere) obstacle.angular_velocity_radps.setZero();
  return true;
}

/// The paper's law is the paper's law and nothing more: it takes obstacles to be where they are said to be.
ObstacleMemory obstacle_memory_of(const Settings& settings) {
  return ObstacleMemory(settings.obstacle_speed_bound_mps,
                        settings.law == Law::kPaper ? 0.0 : settings.timeouts.coast_s);
}

}  // namespace sidestep
