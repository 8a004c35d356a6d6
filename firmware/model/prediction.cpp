#include "firmware/model/prediction.h"

#include <algorithm>

#include "firmware/base/bounded_list.h"
#include "firmware/model/link_proximity.h"
#include "firmware/model/nearest_points.h"

namespace sidestep {
namespace {

/// A link shape in the base frame, and the ball around it.
struct Link {
  const BodyShape& shape;
  const LinkPoses& poses;
  Capsule capsule;
  Vector3 centre;
  double extent_m;
};
using Links = BoundedList<Link, kMaxShapes>;

/// The shapes that move with a joint.
Links moving_links(const Arm& arm, const LinkPoses& poses) {
  Links links;
  for (int s = 0; s < shape_count(arm, poses); ++s) {
    const BodyShape& shape = shape_at(arm, poses, s);
    if (shape.body == 0) continue;
    const Capsule capsule = transformed(poses, shape);
    links.emplace(shape, poses, capsule, capsule.centre(), shape.capsule_body.extent_m());
  }
  return links;
}

/// The least of least_m and the distances of the links to an obstacle in the ball of extent_m around centre.
/// distance_m(capsule, least_m) is called only for links whose ball is nearer to the obstacle's than least_m. Where it
/// is less than least_m and the shape is no capsule, the exact distance to solid() decides. Links of bodies above
/// last_body do not count.
template <typename Distance, typename Solid>
double nearest_m(const Links& links, int last_body, const Vector3& centre, double extent_m, double least_m,
                 const Distance& distance_m, const Solid& solid) {
  for (const Link& link : links) {
    if (link.shape.body > last_body) continue;
    const double near_m = link.extent_m + extent_m + least_m;
    if (near_m <= 0.0 || (link.centre - centre).squaredNorm() >= near_m * near_m) continue;
    double found_m = distance_m(link.capsule, least_m);
    if (found_m < least_m && !link.shape.is_capsule)
      found_m = distance_between_m(solid_of(link.poses, link.shape), solid(), link.centre - centre, least_m);
    least_m = std::min(least_m, found_m);
  }
  return least_m;
}

double nearest_to_sphere_m(const Links& links, int last_body, const Vector3& centre, double radius_m, double least_m) {
  const auto distance_m = [&](const Capsule& link, double) {
    return (centre - nearest_on_segment(link.start, link.end, centre)).norm() - link.radius_m - radius_m;
  };
  return nearest_m(links, last_body, centre, radius_m, least_m, distance_m, [&] {
    return ConvexSolid::of(Capsule{centre, centre, radius_m});
  });
}

double nearest_to_long_m(const Links& links, int last_body, const Obstacle& obstacle, double least_m) {
  const Capsule& capsule = obstacle.capsule;
  const auto distance_m = [&](const Capsule& link, double enough_m) {
    return surface_distance_m(link, obstacle, enough_m);
  };
  return nearest_m(links, last_body, capsule.centre(), capsule.extent_m(), least_m, distance_m,
                   [&] { return solid_of(obstacle); });
}

}  // namespace

Obstacle predicted_obstacle(const Obstacle& obstacle, double after_s) {
  if (obstacle.kind != Kind::kPerson) return extrapolated(obstacle, after_s);
  Obstacle later = extrapolated(obstacle, std::min(after_s, kPersonCoast_s));
  const Vector3 walked_m =
      obstacle.mean_velocity_mps * (std::clamp(after_s, kPersonCoast_s, kPersonWalk_s) - kPersonCoast_s);
  later.capsule.start += walked_m;
  later.capsule.end += walked_m;
  return later;
}

void advance(Obstacle& obstacle, double dt_s, double after_s) {
  if (obstacle.kind == Kind::kPerson && after_s > kPersonCoast_s) {
    if (after_s > kPersonWalk_s) obstacle.mean_velocity_mps.setZero();
    obstacle.velocity_mps = obstacle.mean_velocity_mps;
    obstacle.lead_mps.setZero();
    obstacle.angular_velocity_radps.setZero();
  }
  obstacle = extrapolated(obstacle, dt_s);
}

double clearance_after(const Arm& arm, const LinkPoses& poses, const Obstacle* obstacles, int count, double after_s,
                       double enough_m, const double* allowance_m, bool predicts_persons) {
  const Links links = moving_links(arm, poses);
  double least_m = enough_m;
  for (int o = 0; o < count; ++o) {
    const Obstacle& obstacle = obstacles[o];
    const Capsule& capsule = obstacle.capsule;
    const int last_body = last_body_to_keep_clear(arm, poses, obstacle.id);
    if (last_body < 0) continue;
    const double allowed_m = allowance_m ? allowance_m[o] : 0.0, below_m = least_m - allowed_m;
    const bool is_predicted = predicts_persons && obstacle.kind == Kind::kPerson;
    const auto later = [&] {
      return is_predicted ? predicted_obstacle(obstacle, after_s) : extrapolated(obstacle, after_s);
    };
    // Most obstacles are spheres, and a copy of each would take as long as all the rest.
    const auto centre_later = [&]() -> Vector3 {
      return is_predicted ? later().capsule.start : capsule.start + obstacle.velocity_mps * after_s;
    };
    const double found_m = capsule.is_sphere()
                               ? nearest_to_sphere_m(links, last_body, centre_later(), capsule.radius_m, below_m)
                               : nearest_to_long_m(links, last_body, later(), below_m);
    if (found_m < below_m) least_m = found_m + allowed_m;
  }
  return least_m;
}

}  // namespace sidestep
