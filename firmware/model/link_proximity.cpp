#include "firmware/model/link_proximity.h"

#include <algorithm>

namespace sidestep {
namespace {

/// How much of the exact result counts.
double exact_share(double capsules_m) {
  return std::clamp((kCapsulesAlone_m - capsules_m) / (kCapsulesAlone_m - kExact_m), 0.0, 1.0);
}

Vector3 mixed(const Vector3& capsules, const Vector3& exact, double share) {
  return capsules + share * (exact - capsules);
}

/// Two unit vectors; the exact one if they are opposite.
Vector3 mixed_direction(const Vector3& capsules, const Vector3& exact, double share) {
  const Vector3 sum = mixed(capsules, exact, share);
  const double norm = sum.norm();
  return norm > 1e-6 ? Vector3(sum / norm) : exact;
}

Proximity mixed(const Proximity& capsules, const SolidGap& exact) {
  const double share = exact_share(capsules.distance_m);
  Proximity pair = capsules;
  pair.distance_m += share * (exact.distance_m - capsules.distance_m);
  pair.normal = mixed_direction(capsules.normal, exact.normal, share);
  pair.on_arm = mixed(capsules.on_arm, exact.on_a, share);
  pair.on_obstacle = mixed(capsules.on_obstacle, exact.on_b, share);
  return pair;
}

double separation_m(const ConvexSolid& a, const ConvexSolid& b, const Vector3& normal) {
  const Vector3 opposite = -normal;
  return -opposite.dot(extreme_point(a, opposite)) - normal.dot(extreme_point(b, normal)) - a.radius_m - b.radius_m;
}

/// The distance at one instant and its derivative.
struct Tangent {
  double time_s, distance_m, slope_mps;
};

/// The value where the tangents of a convex function meet: its lower bound between them. first.slope_mps <= 0.
double meeting_m(const Tangent& first, const Tangent& second) {
  if (second.slope_mps <= 0.0) return second.distance_m;
  if (first.slope_mps >= 0.0) return first.distance_m;
  const double duration_s = second.time_s - first.time_s;
  const double rise_m = first.distance_m - second.distance_m + second.slope_mps * duration_s;
  const double after_s = std::clamp(rise_m / (second.slope_mps - first.slope_mps), 0.0, duration_s);
  return first.distance_m + first.slope_mps * after_s;
}

}  // namespace

Proximity refined(const PosedShape& link, const ConvexSolid& obstacle, const Proximity& capsules) {
  if (link.shape.is_capsule || capsules.distance_m >= kCapsulesAlone_m) return capsules;
  return mixed(capsules, gap_between(link.solid(), obstacle, capsules.normal));
}

Proximity measure_pair(const PosedShape& first, const PosedShape& second) {
  Proximity capsules = measure_pair(first.capsule, second.capsule);
  if (first.shape.is_capsule && second.shape.is_capsule) return capsules;
  if (capsules.distance_m >= kCapsulesAlone_m) return capsules;
  SolidGap gap = gap_between(first.solid(), second.solid(), capsules.normal, kCapsulesAlone_m);
  gap.distance_m = std::min(gap.distance_m, kCapsulesAlone_m);
  return mixed(capsules, gap);
}

ClosestApproach refined(const PosedShape& link, const ConvexSolid& obstacle, const Vector3& velocity_mps,
                        const Proximity& now, const ClosestApproach& capsules, double horizon_s) {
  ClosestApproach approach = capsules;
  if (link.shape.is_capsule) return approach;
  if (capsules.time_s <= 0.0) {
    approach.distance_m = now.distance_m;
    approach.on_arm = now.on_arm;
    approach.normal = now.normal;
    return approach;
  }
  const double share = exact_share(capsules.distance_m);
  if (share <= 0.0) return approach;
  const ConvexSolid solid = link.solid();
  const auto gap_at = [&](double time_s) {
    ConvexSolid then = obstacle;
    then.centre += velocity_mps * time_s;
    return gap_between(solid, then, capsules.normal);
  };
  const auto tangent_of = [&](const SolidGap& gap, double time_s) {
    return Tangent{time_s, gap.distance_m, -gap.normal.dot(velocity_mps)};
  };
  const SolidGap gap = gap_at(capsules.time_s);
  double exact_m = 0.0;
  Vector3 normal = capsules.normal, on_arm = capsules.on_arm;
  if (gap.core_m > 0.0 && !capsules.head_on) {
    const Tangent present{0.0, now.distance_m, -now.normal.dot(velocity_mps)}, then = tangent_of(gap, capsules.time_s);
    exact_m =
        then.slope_mps < 0.0 ? meeting_m(then, tangent_of(gap_at(horizon_s), horizon_s)) : meeting_m(present, then);
    normal = gap.normal;
    on_arm = gap.on_a;
  } else {
    ConvexSolid then = obstacle;
    then.centre += velocity_mps * capsules.time_s;
    exact_m = separation_m(solid, then, normal);
    if (capsules.head_on) exact_m = std::min(exact_m, separation_m(solid, then, -normal));
  }
  approach.distance_m += share * (std::max(exact_m, capsules.distance_m) - capsules.distance_m);
  approach.normal = mixed_direction(capsules.normal, normal, share);
  approach.on_arm = mixed(capsules.on_arm, on_arm, share);
  return approach;
}

}  // namespace sidestep
