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

  void gather(const Obstacle& obstacle, int index, double growth_m) {
    const Capsule& reported = obstacle.capsule;
    const Vector3 axis = reported.end - reported.start;
    const Length length = axis.isZero(0.0) ? Length{} : length_of(obstacle, 0.5 * axis.norm());
    const Vector3 centre = reported.start + 0.5 * axis + obstacle.velocity_mps * view_.age_s;
    const double core_m = length.core_m, travel_m = (obstacle.velocity_mps.norm() + length.swing_mps) * horizon_s_;
    const double radii_m = links_.radius_m + reported.radius_m + growth_m;
    if (links_.distance2_m2(centre) > square(length.half_m + reach_m(radii_m, core_m, travel_m))) return;

    const Obstacle present = view_.present(index);
    for (int s = 0; s < static_cast<int>(arm_.shapes.size()); ++s) {
      const Capsule& link = links_.shapes[s];
      const NearestPoints points = nearest_on_axes(link, present.capsule);
      const double distance2_m2 = (points.a - points.b).squaredNorm();
      if (distance2_m2 > square(reach_m(link.radius_m + present.capsule.radius_m, core_m, travel_m))) continue;
      NearPair pair{measure_pair(link, present), {}};
      pair.now.shape = s;
      pair.now.obstacle = index;
      if (pair.now.distance_m < clearance_.nearest.distance_m) clearance_.nearest = pair.now;
      if (arm_.shapes[s].body == 0) continue;
      if (pair.now.axis_distance_m < clearance_.nearest_axis.axis_distance_m) clearance_.nearest_axis = pair.now;
      if (pair.now.distance_m - travel_m > limit_m_) continue;
      pair.velocity_mps = velocity_at(present, pair.now.on_obstacle);
      pair.approach = predict_approach(link, present, pair.now, horizon_s_);
      if (pressing_m(pair) < limit_m_) keep(pair);
    }
  }

 private:
  /// What an obstacle has that is no sphere.
  struct Length {
    double half_m = 0.0;     ///< half its axis
    double core_m = 0.0;     ///< how far a box reaches beyond its axis
    double swing_mps = 0.0;  ///< what turning adds to the speed of its fastest point
  };
  static Length length_of(const Obstacle& obstacle, double half_m) {
    const double radius_m = obstacle.capsule.radius_m;
    return {half_m, obstacle.is_box() ? radius_m : 0.0, obstacle.angular_velocity_radps.norm() * (half_m + radius_m)};
  }

  /// Axes farther apart than this do not matter, with these radii, of which core_m are of a box, and as far as the
  /// obstacle travels.
  double reach_m(double radii_m, double core_m, double travel_m) const {
    const double surface_m = std::max(clearance_.nearest.distance_m, limit_m_ + travel_m);
    return std::max(clearance_.nearest_axis.axis_distance_m + core_m, radii_m + surface_m);
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

Obstacle ObstacleView::present(int index, double later_s) const {
  Obstacle obstacle = moved(at(index), age_s + later_s);
  obstacle.capsule.radius_m += growth_of(index);
  return obstacle;
}

Clearance measure_clearance(const Arm& arm, const Posture& posture, const ObstacleView& view, const Reach& reach) {
  Clearance clearance;
  Gatherer gatherer(arm, posture, view, reach, clearance);
  for (int o = 0; o < view.reported(); ++o) gatherer.gather(view.set->obstacles[o], o, view.growth_m);
  for (int o = view.reported(); o < view.count(); ++o) gatherer.gather(view.at(o), o, 0.0);
  return clearance;
}

}  // namespace sidestep
