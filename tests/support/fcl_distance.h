#pragma once

#include "firmware/model/obstacle.h"
#include "host/sim/solid.h"

namespace sidestep::test {

/// A solid of the simulator at a pose.
struct SolidAtPose {
  sim::Solid solid;
  Eigen::Isometry3d base_from_solid = Eigen::Isometry3d::Identity();
};

inline SolidAtPose solid_at_pose(const Capsule& capsule) {
  const Vector3 axis = capsule.end - capsule.start;
  const Vector3 z = axis.norm() > 0.0 ? axis.normalized() : Vector3(Vector3::UnitZ()), x = z.unitOrthogonal();
  SolidAtPose placed{{sim::Shape::kCapsule, Vector3(capsule.radius_m, axis.norm(), 0)}};
  placed.base_from_solid.linear() << x, z.cross(x), z;
  placed.base_from_solid.translation() = 0.5 * (capsule.start + capsule.end);
  return placed;
}

inline SolidAtPose solid_at_pose(const Box& box) {
  SolidAtPose placed{{sim::Shape::kBox, 2.0 * box.half_m}};
  placed.base_from_solid.linear() = box.axes;
  placed.base_from_solid.translation() = box.centre;
  return placed;
}

inline SolidAtPose solid_at_pose(const Obstacle& obstacle) {
  if (obstacle.shape == Shape::kCylinder) {
    SolidAtPose placed = solid_at_pose(obstacle.capsule);
    placed.solid.shape = sim::Shape::kCylinder;
    return placed;
  }
  return obstacle.shape == Shape::kBox ? solid_at_pose(box_of(obstacle)) : solid_at_pose(obstacle.capsule);
}

/// Distance between surfaces as the simulator computes it, m.
template <typename A, typename B>
double fcl_distance_m(const A& a, const B& b) {
  const SolidAtPose first = solid_at_pose(a), second = solid_at_pose(b);
  return sim::signed_distance_m(first.solid, first.base_from_solid, second.solid, second.base_from_solid);
}

}  // namespace sidestep::test
