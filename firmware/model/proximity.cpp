#include "firmware/model/proximity.h"

namespace sidestep {
namespace {

/// A box on its way past a link that stays where it is. Their distance is a convex function of the time, so that its
/// tangents bound it from below.
class BoxOnItsWay {
 public:
  BoxOnItsWay(const Capsule& link, const Obstacle& obstacle, const Proximity& now)
      : link_(link),
        box_(box_of(obstacle)),
        velocity_mps_(velocity_at(obstacle, now.on_obstacle)),
        radii_m_(link.radius_m + inflation_m(obstacle)),
        least_{0.0, now.distance_m, std::numeric_limits<double>::infinity(), now.on_arm, now.normal} {}

  ClosestApproach closest(const Proximity& now, double horizon_s) {
    Tangent low{0.0, now.distance_m, -now.normal.dot(velocity_mps_)};
    if (low.slope_mps >= 0.0) return least_;
    Tangent high = look(horizon_s);
    for (int i = 0; i < kLooks && high.slope_mps > 0.0; ++i) {
      const double lead_m =
          high.distance_m - low.distance_m + low.slope_mps * low.time_s - high.slope_mps * high.time_s;
      const Tangent between = look(lead_m / (low.slope_mps - high.slope_mps));
      (between.slope_mps < 0.0 ? low : high) = between;
    }
    return least_;
  }

 private:
  static constexpr int kLooks = 4;

  struct Tangent {
    double time_s, distance_m, slope_mps;
  };

  Tangent look(double time_s) {
    const BoxGap gap =
        gap_to_box(link_.start, link_.end, {box_.centre + velocity_mps_ * time_s, box_.axes, box_.half_m});
    const double distance_m = gap.distance_m - radii_m_;
    if (distance_m < least_.distance_m)
      least_ = {time_s, distance_m, least_.axis_distance_m, gap.on_segment, gap.normal};
    return {time_s, distance_m, -gap.normal.dot(velocity_mps_)};
  }

  const Capsule& link_;
  const Box box_;
  const Vector3 velocity_mps_;
  const double radii_m_;
  ClosestApproach least_;
};

Proximity measure_box(const Capsule& link, const Obstacle& obstacle) {
  const BoxGap gap = gap_to_box(link.start, link.end, box_of(obstacle));
  Proximity pair;
  pair.axis_distance_m = gap.distance_m;
  pair.distance_m = gap.distance_m - link.radius_m - inflation_m(obstacle);
  pair.on_arm = gap.on_segment;
  pair.on_obstacle = gap.on_box;
  pair.normal = gap.normal;
  return pair;
}

}  // namespace

Proximity measure_pair(const Capsule& link, const Capsule& obstacle) {
  const NearestPoints points = nearest_on_axes(link, obstacle);
  const Vector3 gap = points.a - points.b;
  return proximity_of(link, obstacle.radius_m, points, gap, gap.norm());
}

Proximity measure_pair(const Capsule& link, const Obstacle& obstacle) {
  return obstacle.is_box() ? measure_box(link, obstacle) : measure_pair(link, obstacle.capsule);
}

double surface_distance_m(const Capsule& link, const Obstacle& obstacle, double enough_m) {
  const NearestPoints points = nearest_on_axes(link, obstacle.capsule);
  const double to_capsule_m = (points.a - points.b).norm() - link.radius_m - obstacle.capsule.radius_m;
  const bool will_do = to_capsule_m >= enough_m || !obstacle.is_box();
  return will_do ? to_capsule_m : measure_box(link, obstacle).distance_m;
}

ClosestApproach predict_closest_approach(const Capsule& link, const Obstacle& obstacle, const Proximity& now,
                                         double horizon_s) {
  if (obstacle.is_box()) return BoxOnItsWay(link, obstacle, now).closest(now, horizon_s);
  return predict_closest_approach(link, obstacle.capsule.radius_m, now.on_obstacle,
                                  velocity_at(obstacle, now.on_obstacle), horizon_s);
}

ClosestApproach predict_closest_approach(const Capsule& link, double radius_m, const Vector3& point,
                                         const Vector3& velocity_mps, double horizon_s) {
  const Vector3 path = velocity_mps * horizon_s;
  const NearestPoints points = nearest_on_axes(link, {point, point + path, 0.0});
  ClosestApproach approach;
  approach.on_arm = points.a;
  const double length2 = path.squaredNorm();
  approach.time_s = length2 > 0.0 ? horizon_s * path.dot(points.b - point) / length2 : 0.0;
  const Vector3 gap = points.a - points.b;
  const double axis_distance_m = approach.axis_distance_m = gap.norm();
  approach.distance_m = axis_distance_m - link.radius_m - radius_m;
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

}  // namespace sidestep
