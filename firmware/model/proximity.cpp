#include "firmware/model/proximity.h"

#include "firmware/model/gjk.h"
#include "firmware/model/pair_proximity.h"

namespace sidestep {
namespace {

/// Finds the closest approach of a convex obstacle that translates at constant velocity past a link at rest. Their
/// distance is then a convex function of time, so that its tangents bound it from below: the search evaluates the
/// distance where the tangents at both ends of the bracket meet, and keeps the nearest of all evaluated instants.
///
/// gap_after(time_s) returns the SegmentGap between the link's axis and the core at that time. radii_m is the sum of
/// the link's radius and the core's inflation: surface distance = gap distance - radii_m.
template <typename GapAfter>
class TangentSearch {
 public:
  TangentSearch(const Proximity& now, const Vector3& velocity_mps, double radii_m, const GapAfter& gap_after)
      : velocity_mps_(velocity_mps),
        radii_m_(radii_m),
        gap_after_(gap_after),
        now_{0.0, now.distance_m, -now.normal.dot(velocity_mps_)},
        nearest_{0.0, now.distance_m, std::numeric_limits<double>::infinity(), now.on_arm, now.normal} {}

  ClosestApproach within(double horizon_s) {
    Tangent low = now_;
    if (low.slope_mps >= 0.0) return nearest_;
    Tangent high = evaluate(horizon_s);
    for (int i = 0; i < kCuts && high.slope_mps > 0.0; ++i) {
      const double lead_m =
          high.distance_m - low.distance_m + low.slope_mps * low.time_s - high.slope_mps * high.time_s;
      const Tangent between = evaluate(lead_m / (low.slope_mps - high.slope_mps));
      (between.slope_mps < 0.0 ? low : high) = between;
    }
    return nearest_;
  }

 private:
  static constexpr int kCuts = 4;

  struct Tangent {
    double time_s, distance_m, slope_mps;
  };

  Tangent evaluate(double time_s) {
    const SegmentGap gap = gap_after_(time_s);
    const double distance_m = gap.distance_m - radii_m_;
    if (distance_m < nearest_.distance_m)
      nearest_ = {time_s, distance_m, nearest_.axis_distance_m, gap.on_segment, gap.normal};
    return {time_s, distance_m, -gap.normal.dot(velocity_mps_)};
  }

  const Vector3 velocity_mps_;
  const double radii_m_;
  const GapAfter& gap_after_;
  const Tangent now_;
  ClosestApproach nearest_;
};

/// The core of a sphere or capsule: the axis of its capsule.
struct AxisCore {
  const Obstacle& obstacle;

  double reach_m() const { return 0.0; }
  Proximity proximity(const Capsule& link) const { return measure_pair(link, obstacle.capsule); }
  double distance_m(const Capsule&, double to_capsule_m) const { return to_capsule_m; }
  ClosestApproach closest_approach(const Capsule& link, const Proximity& now, double horizon_s) const {
    return predict_closest_approach(link, obstacle.capsule.radius_m, now.on_obstacle,
                                    velocity_at(obstacle, now.on_obstacle), horizon_s);
  }
};

/// The core of a solid whose gap to a segment is known: gap(start, end, shift) with the solid moved by `shift`.
template <typename Gap>
struct SolidCore {
  const Obstacle& obstacle;
  double inside_capsule_m;  ///< no point of the core is farther from the axis of the enclosing capsule
  Gap gap;

  double reach_m() const { return inside_capsule_m; }
  Proximity proximity(const Capsule& link) const {
    const SegmentGap nearest = gap(link.start, link.end, Vector3(Vector3::Zero()));
    Proximity pair;
    pair.axis_distance_m = nearest.distance_m;
    pair.distance_m = nearest.distance_m - link.radius_m - inflation_m(obstacle);
    pair.on_arm = nearest.on_segment;
    pair.on_obstacle = nearest.on_solid;
    pair.normal = nearest.normal;
    return pair;
  }
  double distance_m(const Capsule& link, double) const { return proximity(link).distance_m; }
  ClosestApproach closest_approach(const Capsule& link, const Proximity& now, double horizon_s) const {
    const Vector3 velocity_mps = velocity_at(obstacle, now.on_obstacle);
    const auto gap_after = [&](double time_s) { return gap(link.start, link.end, Vector3(velocity_mps * time_s)); };
    return TangentSearch(now, velocity_mps, link.radius_m + inflation_m(obstacle), gap_after).within(horizon_s);
  }
};

auto box_core(const Obstacle& obstacle) {
  const auto gap = [box = box_of(obstacle)](const Vector3& start, const Vector3& end, const Vector3& shift) {
    return gap_to_box(start, end, {box.centre + shift, box.axes, box.half_m});
  };
  return SolidCore<decltype(gap)>{obstacle, obstacle.capsule.radius_m, gap};
}

ConvexSolid core_of(const Obstacle& obstacle) {
  ConvexSolid core = solid_of(obstacle);
  core.radius_m = 0.0;
  return core;
}

auto cylinder_core(const Obstacle& obstacle) {
  const auto gap = [cylinder = core_of(obstacle)](const Vector3& start, const Vector3& end, const Vector3& shift) {
    ConvexSolid moved = cylinder;
    moved.centre += shift;
    const Vector3 apart = 0.5 * (start + end) - moved.centre;
    const ConvexSolid segment = ConvexSolid::of(Capsule{start, end, 0.0});
    const SolidGap exact = gap_between(segment, moved, apart.isZero(0.0) ? Vector3(Vector3::UnitX()) : apart);
    return SegmentGap{exact.core_m, exact.on_a, exact.on_b, exact.normal};
  };
  return SolidCore<decltype(gap)>{obstacle, obstacle.half_thickness_m, gap};
}

/// compute(core) with the core of the obstacle's shape: the one place where the shape decides what is computed.
template <typename Compute>
auto with_core(const Obstacle& obstacle, const Compute& compute) {
  switch (obstacle.shape) {
    case Shape::kBox:
      return compute(box_core(obstacle));
    case Shape::kCylinder:
      return compute(cylinder_core(obstacle));
    case Shape::kSphere:
    case Shape::kCapsule:
      break;
  }
  return compute(AxisCore{obstacle});
}

}  // namespace

Proximity measure_pair(const Capsule& link, const Capsule& obstacle) {
  const NearestPoints points = nearest_on_axes(link, obstacle);
  const Vector3 gap = points.a - points.b;
  return proximity_of(link, obstacle.radius_m, points, gap, gap.norm());
}

Proximity measure_pair(const Capsule& link, const Obstacle& obstacle) {
  return with_core(obstacle, [&](const auto& core) { return core.proximity(link); });
}

double surface_distance_m(const Capsule& link, const Obstacle& obstacle, double enough_m) {
  const NearestPoints points = nearest_on_axes(link, obstacle.capsule);
  const double to_capsule_m = (points.a - points.b).norm() - link.radius_m - obstacle.capsule.radius_m;
  if (to_capsule_m >= enough_m) return to_capsule_m;
  return with_core(obstacle, [&](const auto& core) { return core.distance_m(link, to_capsule_m); });
}

double core_reach_m(const Obstacle& obstacle) {
  return with_core(obstacle, [](const auto& core) { return core.reach_m(); });
}

ClosestApproach predict_closest_approach(const Capsule& link, const Obstacle& obstacle, const Proximity& present,
                                         double horizon_s) {
  return with_core(obstacle, [&](const auto& core) { return core.closest_approach(link, present, horizon_s); });
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
  // A path through the axis itself can be avoided to either side; below this distance the side is still open.
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
