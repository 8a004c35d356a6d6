#include "firmware/model/clearance.h"

#include <algorithm>

#include "firmware/model/link_proximity.h"
#include "firmware/model/pair_proximity.h"

namespace sidestep {
namespace {

/// A link shape in the base frame.
struct Link {
  Capsule capsule;
  Vector3 axis;
  double per_length2;  ///< 1 / |axis|^2, 1/m2; 0 for a sphere
  int body;

  /// From the nearest point of the axis to p.
  Vector3 gap_to(const Vector3& p) const {
    const Vector3 from_start = p - capsule.start;
    return from_start - std::clamp(axis.dot(from_start) * per_length2, 0.0, 1.0) * axis;
  }
};

/// The link shapes in the base frame, and the axis-aligned box around their axes.
struct Links {
  BoundedList<Link, kMaxShapes> shapes;
  Vector3 lower = Vector3::Constant(std::numeric_limits<double>::infinity());
  Vector3 upper = -lower;
  double radius_m = 0.0;  // the largest of all shapes

  Links(const Arm& arm, const LinkPoses& poses, const BoundedList<Capsule, kMaxShapes>& capsules) {
    for (int s = 0; s < capsules.size(); ++s) {
      const Capsule& capsule = capsules[s];
      const Vector3 axis = capsule.end - capsule.start;
      const double length2_m2 = axis.squaredNorm();
      shapes.add({capsule, axis, length2_m2 > 0.0 ? 1.0 / length2_m2 : 0.0, shape_at(arm, poses, s).body});
      lower = lower.cwiseMin(capsule.start).cwiseMin(capsule.end);
      upper = upper.cwiseMax(capsule.start).cwiseMax(capsule.end);
      radius_m = std::max(radius_m, capsule.radius_m);
    }
  }
  /// A lower bound of the squared distance from p to any link axis.
  double distance2_m2(const Vector3& p) const { return (p - p.cwiseMax(lower).cwiseMin(upper)).squaredNorm(); }
};

double square(double x) {
  return x * x;
}

/// Computes a Clearance, obstacle by obstacle. One comparison of squared distances discards most pairs.
class Gatherer {
 public:
  /// clearance.links has been filled.
  Gatherer(const Arm& arm, const LinkPoses& poses, const ObstacleView& view, const Reach& reach, Clearance& clearance)
      : arm_(arm),
        poses_(poses),
        links_(arm, poses, clearance.links),
        view_(view),
        horizon_s_(reach.horizon_s),
        reach_(reach),
        clearance_(clearance) {}

  void gather(const Obstacle& obstacle, int index, double growth_m) {
    last_body_ = last_body_to_keep_clear(arm_, poses_, obstacle.id);
    if (last_body_ < 0) return;
    limit_m_ = std::min(listed_m_, range_of(obstacle));
    if (obstacle.capsule.is_sphere())
      gather_sphere(obstacle, index, growth_m);
    else
      gather_long(obstacle, index, growth_m);
  }

 private:
  double range_of(const Obstacle& obstacle) const {
    return obstacle.kind == Kind::kPerson ? std::max(reach_.range_m, reach_.person_range_m) : reach_.range_m;
  }

  /// The distance from a point to a link is a convex function of the point: along a straight path it never decreases
  /// faster than the tangent at the start, horizon_s * closing speed in all.
  void gather_sphere(const Obstacle& obstacle, int index, double growth_m) {
    const Vector3& velocity_mps = obstacle.velocity_mps;
    const Vector3 centre = obstacle.capsule.start + velocity_mps * view_.age_s;
    const double radius_m = obstacle.capsule.radius_m + growth_m, radii_m = links_.radius_m + radius_m;
    const double travel_m = velocity_mps.norm() * horizon_s_;
    double reach2_m2 = square(relevant_axis_distance_m(radii_m, 0.0, travel_m));
    if (links_.distance2_m2(centre) > reach2_m2) return;

    for (int s = 0; s < links_.shapes.size(); ++s) {
      const Link& link = links_.shapes[s];
      if (link.body > last_body_) continue;
      const Vector3 gap = link.gap_to(centre);
      const double distance2_m2 = gap.squaredNorm();
      if (distance2_m2 > reach2_m2) continue;
      const double distance_m = std::sqrt(distance2_m2);
      const double closing_m = std::max(0.0, std::min(travel_m, horizon_s_ * -velocity_mps.dot(gap) / distance_m));
      if (distance_m > relevant_axis_distance_m(link, radii_m, closing_m)) continue;
      const Proximity now = proximity_of(link.capsule, radius_m, {centre - gap, centre}, -gap, distance_m);
      const auto solid = [&] { return ConvexSolid::of(Capsule{centre, centre, radius_m}); };
      add_pair(
          s, index, now, solid, [&](const Vector3&) { return velocity_mps; }, travel_m,
          [&] {
            if (closing_m == 0.0)
              return ClosestApproach{0.0, now.distance_m, now.axis_distance_m, now.on_arm, now.normal};
            return predict_closest_approach(link.capsule, radius_m, centre, velocity_mps, horizon_s_);
          });
      reach2_m2 = square(relevant_axis_distance_m(radii_m, 0.0, travel_m));
    }
  }

  /// Any obstacle that is no sphere: first discarded by the axis of its enclosing capsule.
  void gather_long(const Obstacle& obstacle, int index, double growth_m) {
    const Capsule& reported = obstacle.capsule;
    const Vector3 half_axis = 0.5 * (reported.end - reported.start);
    const double half_length_m = half_axis.norm(), core_m = core_reach_m(obstacle);
    const double swing_mps = obstacle.angular_velocity_radps.norm() * (half_length_m + reported.radius_m);
    const Vector3 centre = reported.start + half_axis + obstacle.velocity_mps * view_.age_s;
    const double travel_m = (obstacle.velocity_mps.norm() + swing_mps) * horizon_s_;
    const double radii_m = links_.radius_m + reported.radius_m + growth_m;
    const double from_centre_m = half_length_m + relevant_axis_distance_m(radii_m, core_m, travel_m);
    if (links_.distance2_m2(centre) > square(from_centre_m)) return;

    const Obstacle present = view_.extrapolated(index);
    for (int s = 0; s < links_.shapes.size(); ++s) {
      if (links_.shapes[s].body > last_body_) continue;
      const Capsule& link = links_.shapes[s].capsule;
      const NearestPoints points = nearest_on_axes(link, present.capsule);
      if ((points.a - points.b).squaredNorm() > square(relevant_axis_distance_m(radii_m, core_m, travel_m))) continue;
      const Proximity now = measure_pair(link, present);
      const auto velocity = [&](const Vector3& point) { return velocity_at(present, point); };
      add_pair(
          s, index, now, [&] { return solid_of(present); }, velocity, travel_m,
          [&] { return predict_closest_approach(link, present, now, horizon_s_); });
    }
  }

  /// Updates the results with one pair. now: that of the link's enclosing capsule. solid() returns the obstacle's exact
  /// shape, velocity(point) that of its material; travel_m: the farthest that any point of it moves within the horizon;
  /// predict() returns the ClosestApproach of the capsule.
  template <typename Solid, typename Velocity, typename Predict>
  void add_pair(int shape, int obstacle, Proximity now, const Solid& solid, const Velocity& velocity, double travel_m,
                const Predict& predict) {
    const BodyShape& link = shape_at(arm_, poses_, shape);
    const PosedShape posed{link, poses_, links_.shapes[shape].capsule};
    now.shape = shape;
    now.obstacle = obstacle;
    if (now.distance_m < clearance_.nearest.distance_m) find_nearest(posed, solid, now);
    if (link.body == 0) return;
    if (now.axis_distance_m < clearance_.nearest_axis.axis_distance_m) clearance_.nearest_axis = now;
    if (now.distance_m - travel_m > limit_m_) return;
    const ClosestApproach of_capsule = predict();
    if (link.is_capsule) return consider(now, of_capsule, velocity(now.on_obstacle));
    const bool relevant = std::min(now.distance_m, of_capsule.distance_m) < std::min(limit_m_, kCapsulesAlone_m);
    if (!relevant) return consider(now, of_capsule, velocity(now.on_obstacle));
    const ConvexSolid exact = solid();
    now = refined(posed, exact, now);
    const Vector3 velocity_mps = velocity(now.on_obstacle);
    consider(now, refined(posed, exact, velocity_mps, now, of_capsule, horizon_s_), velocity_mps);
  }

  /// Replaces the nearest pair if the exact distance is less.
  template <typename Solid>
  void find_nearest(const PosedShape& link, const Solid& solid, const Proximity& capsules) {
    Proximity& nearest = clearance_.nearest;
    if (link.shape.is_capsule) {
      nearest = capsules;
      return;
    }
    const SolidGap gap = gap_between(link.solid(), solid(), capsules.normal, nearest.distance_m);
    if (gap.distance_m >= nearest.distance_m) return;
    nearest = capsules;
    nearest.distance_m = gap.distance_m;
    nearest.on_arm = gap.on_a;
    nearest.on_obstacle = gap.on_b;
    nearest.normal = gap.normal;
  }

  void consider(const Proximity& now, const ClosestApproach& approach, const Vector3& velocity_mps) {
    if (std::min(now.distance_m, approach.distance_m) < limit_m_) keep(now, approach, velocity_mps);
  }

  /// The axis distance beyond which a pair changes no result. radii_m: of the thickest link plus the obstacle's
  /// enclosing capsule; core_m: core_reach_m() of the obstacle; travel_m: as in add_pair().
  double relevant_axis_distance_m(double radii_m, double core_m, double travel_m) const {
    const double surface_m = std::max(clearance_.nearest.distance_m, limit_m_ + travel_m);
    return std::max(clearance_.nearest_axis.axis_distance_m + core_m, radii_m + surface_m);
  }

  /// The same for a sphere and one link: a link that does not move can only change Clearance::nearest.
  double relevant_axis_distance_m(const Link& link, double radii_m, double travel_m) const {
    return link.body > 0 ? relevant_axis_distance_m(radii_m, 0.0, travel_m) : radii_m + clearance_.nearest.distance_m;
  }

  /// Adds a pair to the list. In a full list it replaces the least urgent pair if it is more urgent, and limit_m_ is a
  /// distance from which on no pair can be.
  void keep(const Proximity& now, const ClosestApproach& approach, const Vector3& velocity_mps) {
    auto& near = clearance_.near;
    const NearPair pair{now, approach, velocity_mps};
    if (near.is_full()) {
      const double margin_m = margin_of(pair);
      if (margin_m >= margins_m_[least_urgent_]) return;
      near[least_urgent_] = pair;
      margins_m_[least_urgent_] = margin_m;
    } else {
      near.add(pair);
      if (!near.is_full()) return;
      find_fastest_link();
      for (const NearPair& listed : near) margins_m_.add(margin_of(listed));
    }
    least_urgent_ = static_cast<int>(std::max_element(margins_m_.begin(), margins_m_.end()) - margins_m_.begin());
    listed_m_ = margins_m_[least_urgent_] + fastest_mps_ * reach_.stopping_s;
    limit_m_ = std::min(limit_m_, listed_m_);
  }

  /// What is left of the distance of a pair when the arm has stopped, m; the less, the more urgent the pair.
  double margin_of(const NearPair& pair) const {
    const double distance_m = pair.least_distance_m();
    if (fastest_mps_ == 0.0) return distance_m;
    const int body = links_.shapes[pair.now.shape].body;
    const Vector3 link_mps = point_velocity(poses_, body, pair.now.on_arm, *reach_.velocity_radps);
    return distance_m - std::max(0.0, -pair.now.normal.dot(link_mps)) * reach_.stopping_s;
  }

  /// A bound of the speed of all points of the links. Along an axis the ends are fastest.
  void find_fastest_link() {
    if (!reach_.velocity_radps) return;
    const JointVector& velocity_radps = *reach_.velocity_radps;
    for (const Link& link : links_.shapes)
      for (const Vector3& end : {link.capsule.start, link.capsule.end})
        fastest_mps_ = std::max(fastest_mps_, point_velocity(poses_, link.body, end, velocity_radps).norm());
    fastest_mps_ += velocity_radps.cwiseAbs().sum() * links_.radius_m;
  }

  const Arm& arm_;
  const LinkPoses& poses_;
  const Links links_;
  const ObstacleView& view_;
  const double horizon_s_;
  const Reach reach_;
  double listed_m_ = std::numeric_limits<double>::infinity();  ///< no pair with this distance enters a full list
  double limit_m_ = 0.0;  ///< pairs of this obstacle whose least distance is not below this are not kept
  Clearance& clearance_;
  int last_body_ = 0;                        ///< links of bodies above may touch the obstacle
  BoundedList<double, kMaxNear> margins_m_;  ///< margin_of() each pair of a full list
  int least_urgent_ = 0;                     ///< index of the largest of them
  double fastest_mps_ = 0.0;                 ///< find_fastest_link()
};

}  // namespace

Obstacle ObstacleView::extrapolated(int index, double later_s) const {
  Obstacle obstacle = sidestep::extrapolated(at(index), age_s + later_s);
  obstacle.capsule.radius_m += growth_of(index);
  return obstacle;
}

Clearance measure_clearance(const Arm& arm, const LinkPoses& poses, const ObstacleView& view, const Reach& reach) {
  Clearance clearance;
  for (int s = 0; s < shape_count(arm, poses); ++s) clearance.links.add(transformed(poses, shape_at(arm, poses, s)));
  Gatherer gatherer(arm, poses, view, reach, clearance);
  for (int o = 0; o < view.in_set(); ++o) gatherer.gather(view.set->obstacles[o], o, view.growth_m);
  for (int o = view.in_set(); o < view.count(); ++o) gatherer.gather(view.at(o), o, 0.0);
  return clearance;
}

}  // namespace sidestep
