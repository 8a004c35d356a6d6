#include "firmware/model/turning_proximity.h"

namespace sidestep {
namespace {

constexpr double kSamePoint_m = 0.01;

/// measure(ball, on_link): the Proximity of a point of one solid, grown by that solid's radius, and the other solid;
/// on_link: whether the point is one of the link's.
template <typename Measure>
BoundedList<Proximity, 2> after_turn(const ConvexSolid& link, const ConvexSolid& other, const Proximity& now,
                                     const Vector3& turn_rad, const Measure& measure) {
  BoundedList<Proximity, 2> result;
  const auto consider = [&](const ConvexSolid& solid, const Vector3& direction, const Vector3& present, bool on_link) {
    const Vector3 next = extreme_point(solid, direction);
    if ((next - present).norm() <= kSamePoint_m) return;
    Proximity pair = measure(Capsule{next, next, solid.radius_m}, on_link);
    pair.shape = now.shape;
    pair.obstacle = now.obstacle;
    result.add(pair);
  };
  const Vector3 tilt = now.normal.cross(turn_rad);
  consider(link, -(now.normal + tilt), now.on_arm, true);
  consider(other, now.normal - tilt, now.on_obstacle, false);
  return result;
}

/// Of a shape to a ball in the place of the obstacle.
Proximity to_ball(const PosedShape& shape, const Capsule& ball) {
  return refined(shape, ConvexSolid::of(ball), measure_pair(shape.capsule, ball));
}

Proximity swapped(Proximity pair) {
  std::swap(pair.on_arm, pair.on_obstacle);
  pair.normal = -pair.normal;
  return pair;
}

}  // namespace

BoundedList<Proximity, 2> proximities_after_turn(const PosedShape& link, const Obstacle& obstacle, const Proximity& now,
                                                 const Vector3& turn_rad) {
  return after_turn(link.solid(), solid_of(obstacle), now, turn_rad, [&](const Capsule& ball, bool on_link) {
    return on_link ? measure_pair(ball, obstacle) : to_ball(link, ball);
  });
}

BoundedList<Proximity, 2> proximities_after_turn(const PosedShape& first, const PosedShape& second,
                                                 const Proximity& now, const Vector3& turn_rad) {
  return after_turn(first.solid(), second.solid(), now, turn_rad, [&](const Capsule& ball, bool on_first) {
    return on_first ? swapped(to_ball(second, ball)) : to_ball(first, ball);
  });
}

}  // namespace sidestep
