#include "firmware/model/clearance.h"

#include <algorithm>

namespace sidestep {
namespace {

/// The arm's shapes where they are, and the box around their axes.
struct Links {
  std::array<Capsule, kMaxShapes> shapes;
  Vector3 lower = Vector3::Constant(std::numeric_limits<double>::infinity());
  Vector3 upper = -lower;
  double radius_m = 0.0;  // the largest of the shapes

  Links(const Arm& arm, const Posture& posture) {
    for (size_t s = 0; s < arm.shapes.size(); ++s) {
      const Capsule& link = shapes[s] = placed(posture, arm.shapes[s]);
      lower = lower.cwiseMin(link.start).cwiseMin(link.end);
      upper = upper.cwiseMax(link.start).cwiseMax(link.end);
      radius_m = std::max(radius_m, link.radius_m);
    }
  }
  /// No axis of the arm is nearer to p than the square root of this.
  double distance2_m2(const Vector3& p) const { return (p - p.cwiseMax(lower).cwiseMin(upper)).squaredNorm(); }
};

/// How pressing a pair is: the nearer now or at its approach, the more.
double pressing_m(const NearPair& pair) {
  return std::min(pair.now.distance_m, pair.approach.distance_m);
}

double square(double x) {
  return x * x;
}

Proximity proximity(const Capsule& link, const Capsule& obstacle, const NearestPoints& points) {
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

/// The closest approach of a point of an obstacle with this radius.
Approach approach_of(const Capsule& link, double radius_m, const Vector3& point, const Vector3& velocity_mps,
                     double horizon_s) {
  const Vector3 path = velocity_mps * horizon_s;
  const NearestPoints points = nearest_on_axes(link, {point, point + path, 0.0});
  Approach approach;
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

/// Gathers a Clearance, obstacle by obstacle. Most pairs turn out not to matter by one comparison of squares.
class Gatherer {
 public:
  Gatherer(const Arm& arm, const Posture& posture, const ObstacleView& view, const Reach& reach, Clearance& clearance)
      : arm_(arm),
        links_(arm, posture),
        view_(view),
        horizon_s_(reach.horizon_s),
        limit_m_(reach.range_m),
        clearance_(clearance) {}

  void gather(int index) {
    const Obstacle& obstacle = view_.set->obstacles[index];
    const Capsule& reported = obstacle.capsule;
    const Vector3 axis = reported.end - reported.start;
    const double half_length_m = axis.isZero(0.0) ? 0.0 : 0.5 * axis.norm();
    const Vector3 centre = reported.start + 0.5 * axis + obstacle.velocity_mps * view_.age_s;
    const double travel_m = obstacle.velocity_mps.norm() * horizon_s_;
    const double radii_m = links_.radius_m + reported.radius_m + view_.growth_m;
    if (links_.distance2_m2(centre) > square(half_length_m + reach_m(radii_m, travel_m))) return;

    Capsule present = moved(obstacle, view_.age_s);
    present.radius_m += view_.growth_m;
    for (int s = 0; s < static_cast<int>(arm_.shapes.size()); ++s) {
      const Capsule& link = links_.shapes[s];
      const NearestPoints points = nearest_on_axes(link, present);
      const double distance2_m2 = (points.a - points.b).squaredNorm();
      if (distance2_m2 > square(reach_m(link.radius_m + present.radius_m, travel_m))) continue;
      NearPair pair{proximity(link, present, points), {}};
      pair.now.shape = s;
      pair.now.obstacle = index;
      if (pair.now.distance_m < clearance_.nearest.distance_m) clearance_.nearest = pair.now;
      if (arm_.shapes[s].body == 0) continue;
      if (pair.now.axis_distance_m < clearance_.nearest_axis.axis_distance_m) clearance_.nearest_axis = pair.now;
      if (pair.now.distance_m - travel_m > limit_m_) continue;
      pair.approach = approach_of(link, present.radius_m, points.b, obstacle.velocity_mps, horizon_s_);
      if (pressing_m(pair) < limit_m_) keep(pair);
    }
  }

 private:
  /// Axes farther apart than this do not matter, with these radii and as far as the obstacle travels.
  double reach_m(double radii_m, double travel_m) const {
    const double surface_m = std::max(clearance_.nearest.distance_m, limit_m_ + travel_m);
    return std::max(clearance_.nearest_axis.axis_distance_m, radii_m + surface_m);
  }

  /// As soon as the list is full, only what is more pressing than the least pressing there comes in, for that one.
  void keep(const NearPair& pair) {
    auto& near = clearance_.near;
    near[clearance_.near_count < kMaxNear ? clearance_.near_count++ : least_] = pair;
    if (clearance_.near_count < kMaxNear) return;
    const auto less = [](const NearPair& a, const NearPair& b) { return pressing_m(a) < pressing_m(b); };
    least_ = std::max_element(near.begin(), near.end(), less) - near.begin();
    limit_m_ = pressing_m(near[least_]);
  }

  const Arm& arm_;
  const Links links_;
  const ObstacleView& view_;
  const double horizon_s_;
  double limit_m_;  ///< pairs that do not come nearer are not kept
  Clearance& clearance_;
  std::ptrdiff_t least_ = 0;  ///< pressing pair of a full list
};

}  // namespace

Proximity measure_pair(const Capsule& link, const Capsule& obstacle) {
  return proximity(link, obstacle, nearest_on_axes(link, obstacle));
}

Approach predict_approach(const Capsule& link, const Capsule& obstacle, const Vector3& velocity_mps, double horizon_s) {
  return approach_of(link, obstacle.radius_m, nearest_on_axes(link, obstacle).b, velocity_mps, horizon_s);
}

Clearance measure_clearance(const Arm& arm, const Posture& posture, const ObstacleView& view, const Reach& reach) {
  Clearance clearance;
  if (!view.set) return clearance;
  Gatherer gatherer(arm, posture, view, reach, clearance);
  for (int o = 0; o < view.set->count; ++o) gatherer.gather(o);
  return clearance;
}

}  // namespace sidestep
