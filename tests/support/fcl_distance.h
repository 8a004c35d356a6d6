#pragma once

#include "firmware/model/obstacle.h"
#include "host/sim/solid.h"

namespace sidestep::test {

/// A solid of the simulator at a pose.
struct PlacedSolid {
  sim::Solid solid;
  Eigen::Isometry3d base_from_solid = Eigen::Isometry3d::Identity();
};

inline PlacedSolid placed_solid(const Capsule& capsule) {
  const Vector3 axis = capsule.end - capsule.start;
  const Vector3 z = axis.norm() > 0.0 ? axis.normalized() : Vector3(Vector3::UnitZ()), x = z.unitOrthogonal();
  PlacedSolid placed{{sim::Shape::kCapsule, Vector3(capsule.radius_m, axis.norm(), 0)}};
  placed.base_from_solid.linear() << x, z.cross(x), z;
  placed.base_from_solid.translation() = 0.5 * (capsule.start + capsule.end);
  return placed;
}

inline PlacedSolid placed_solid(const Box& box) {
  PlacedSolid placed{{sim::Shape::kBox, 2.0 * box.half_m}};
  placed.base_from_solid.linear() = box.axes;
  placed.base_from_solid.translation() = box.centre;
  return placed;
}

inline PlacedSolid placed_solid(const Obstacle& obstacle) {
  return obstacle.shape == Shape::kBox ? placed_solid(box_of(obstacle)) : placed_solid(obstacle.capsule);
}

/// Distance between surfaces as the simulator computes it, m.
template <typename A, typename B>
double fcl_distance_m(const A& a, const B& b) {
  const PlacedSolid first = placed_solid(a), second = placed_solid(b);
  return sim::signed_distance_m(first.solid, first.base_from_solid, second.solid, second.base_from_solid);
}

}  // namespace sidestep::test
