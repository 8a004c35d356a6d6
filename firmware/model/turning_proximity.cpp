#include "firmware/model/turning_proximity.h"

namespace sidestep {
namespace {

constexpr double kSamePoint_m = 0.01;

Capsule ball(const Vector3& centre, double radius_m) {
  return {centre, centre, radius_m};
}

}  // namespace

BoundedList<Proximity, 2> proximities_after_turn(const PosedShape& link, const Obstacle& obstacle, const Proximity& now,
                                                 const Vector3& turn_rad) {
  BoundedList<Proximity, 2> result;
  const auto add = [&](Proximity pair) {
    pair.shape = now.shape;
    pair.obstacle = now.obstacle;
    result.add(pair);
  };
  const Vector3 tilt = now.normal.cross(turn_rad);

  const ConvexSolid of_link = link.solid();
  const Vector3 of_link_next = extreme_point(of_link, -(now.normal + tilt));
  if ((of_link_next - now.on_arm).norm() > kSamePoint_m)
    add(measure_pair(ball(of_link_next, of_link.radius_m), obstacle));

  const ConvexSolid of_obstacle = solid_of(obstacle);
  const Vector3 of_obstacle_next = extreme_point(of_obstacle, now.normal - tilt);
  if ((of_obstacle_next - now.on_obstacle).norm() > kSamePoint_m) {
    const Capsule point = ball(of_obstacle_next, of_obstacle.radius_m);
    add(refined(link, ConvexSolid::of(point), measure_pair(link.capsule, point)));
  }
  return result;
}

}  // namespace sidestep
