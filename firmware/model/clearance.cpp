#include "firmware/model/clearance.h"

#include <algorithm>

namespace sidestep {
namespace {

/// Box around the axes of the arm's shapes.
struct Bounds {
  Vector3 lower = Vector3::Constant(std::numeric_limits<double>::infinity());
  Vector3 upper = -lower;
  double radius_m = 0.0;  // the largest of the shapes

  void include(const Capsule& capsule) {
    lower = lower.cwiseMin(capsule.start).cwiseMin(capsule.end);
    upper = upper.cwiseMax(capsule.start).cwiseMax(capsule.end);
    radius_m = std::max(radius_m, capsule.radius_m);
  }
  /// No axis inside the box is nearer to p than this.
  double distance_m(const Vector3& p) const { return (p - p.cwiseMax(lower).cwiseMin(upper)).norm(); }
};

/// How pressing a pair is: the nearer now or at its approach, the more.
double pressing_m(const NearPair& pair) {
  return std::min(pair.now.distance_m, pair.approach.distance_m);
}

void keep_near(Clearance& clearance, const NearPair& pair) {
  if (clearance.near_count < kMaxNear) {
    clearance.near[clearance.near_count++] = pair;
    return;
  }
  const auto least = std::max_element(clearance.near.begin(), clearance.near.end(),
                                      [](const auto& a, const auto& b) { return pressing_m(a) < pressing_m(b); });
  if (pressing_m(pair) < pressing_m(*least)) *least = pair;
}

}  // namespace

Proximity measure_pair(const Capsule& link, const Capsule& obstacle) {
  const NearestPoints points = nearest_on_axes(link, obstacle);
  Proximity pair;
  pair.on_arm = points.a;
  pair.on_obstacle = points.b;
  const Vector3 gap = points.a - points.b;
  pair.axis_distance_m = gap.norm();
  pair.distance_m = pair.axis_distance_m - link.radius_m - obstacle.radius_m;
  if (pair.axis_distance_m > 1e-9)
    pair.normal = gap / pair.axis_distance_m;
  else if (link.end != link.start)  // the axes meet: any way out across the link
    pair.normal = (link.end - link.start).unitOrthogonal();
  return pair;
}

Approach predict_approach(const Capsule& link, const Capsule& obstacle, const Vector3& velocity_mps, double horizon_s) {
  const Vector3 point = nearest_on_axes(link, obstacle).b;
  const Vector3 path = velocity_mps * horizon_s;
  const NearestPoints points = nearest_on_axes(link, {point, point + path, 0.0});
  Approach approach;
  approach.on_arm = points.a;
  const double length2 = path.squaredNorm();
  approach.time_s = length2 > 0.0 ? horizon_s * path.dot(points.b - point) / length2 : 0.0;
  const Vector3 gap = points.a - points.b;
  const double axis_distance_m = approach.axis_distance_m = gap.norm();
  approach.distance_m = axis_distance_m - link.radius_m - obstacle.radius_m;
  // A path through the axis itself can be left to either side; within this distance the side is not yet decided.
  const double undecided_m = 0.005;
  approach.head_on = axis_distance_m < undecided_m;
  if (!approach.head_on) {
    approach.normal = gap / axis_distance_m;
    return approach;
  }
  const Vector3 across = path.cross(link.end - link.start);
  approach.normal = across.norm() > 1e-9 ? across.normalized() : path.unitOrthogonal();
  return approach;
}

Clearance measure_clearance(const Arm& arm, const Posture& posture, const ObstacleView& view, const Reach& reach) {
  Clearance clearance;
  if (!view.set) return clearance;

  std::array<Capsule, kMaxShapes> links;
  Bounds bounds;
  const int shapes = static_cast<int>(arm.shapes.size());
  for (int s = 0; s < shapes; ++s) {
    links[s] = placed(posture, arm.shapes[s]);
    bounds.include(links[s]);
  }

  for (int o = 0; o < view.set->count; ++o) {
    const Obstacle& obstacle = view.set->obstacles[o];
    const Capsule& reported = obstacle.capsule;
    const Vector3 centre = 0.5 * (reported.start + reported.end) + obstacle.velocity_mps * view.age_s;
    const double half_length_m = 0.5 * (reported.end - reported.start).norm();
    const double axis_bound_m = bounds.distance_m(centre) - half_length_m;
    const double surface_bound_m = axis_bound_m - bounds.radius_m - reported.radius_m - view.growth_m;
    if (surface_bound_m - obstacle.velocity_mps.norm() * reach.horizon_s > reach.range_m &&
        surface_bound_m > clearance.nearest.distance_m && axis_bound_m > clearance.nearest_axis.axis_distance_m)
      continue;

    Capsule present = moved(obstacle, view.age_s);
    present.radius_m += view.growth_m;
    for (int s = 0; s < shapes; ++s) {
      Proximity now = measure_pair(links[s], present);
      now.shape = s;
      now.obstacle = o;
      if (now.distance_m < clearance.nearest.distance_m) clearance.nearest = now;
      if (arm.shapes[s].body == 0) continue;
      if (now.axis_distance_m < clearance.nearest_axis.axis_distance_m) clearance.nearest_axis = now;
      const NearPair pair{now, predict_approach(links[s], present, obstacle.velocity_mps, reach.horizon_s)};
      if (pressing_m(pair) < reach.range_m) keep_near(clearance, pair);
    }
  }
  return clearance;
}

}  // namespace sidestep
