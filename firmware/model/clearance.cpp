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

void keep_near(Clearance& clearance, const Proximity& pair) {
  if (clearance.near_count < kMaxNear) {
    clearance.near[static_cast<size_t>(clearance.near_count++)] = pair;
    return;
  }
  const auto farthest =
      std::max_element(clearance.near.begin(), clearance.near.end(),
                       [](const Proximity& a, const Proximity& b) { return a.distance_m < b.distance_m; });
  if (pair.distance_m < farthest->distance_m) *farthest = pair;
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

Clearance measure_clearance(const Arm& arm, const Posture& posture, const ObstacleView& view, double range_m) {
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
    if (surface_bound_m > range_m && surface_bound_m > clearance.nearest.distance_m &&
        axis_bound_m > clearance.nearest_axis.axis_distance_m)
      continue;

    Capsule present = moved(obstacle, view.age_s);
    present.radius_m += view.growth_m;
    for (int s = 0; s < shapes; ++s) {
      Proximity pair = measure_pair(links[s], present);
      pair.shape = s;
      pair.obstacle = o;
      if (pair.distance_m < clearance.nearest.distance_m) clearance.nearest = pair;
      if (arm.shapes[s].body == 0) continue;
      if (pair.axis_distance_m < clearance.nearest_axis.axis_distance_m) clearance.nearest_axis = pair;
      if (pair.distance_m < range_m) keep_near(clearance, pair);
    }
  }
  return clearance;
}

}  // namespace sidestep
