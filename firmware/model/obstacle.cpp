#include "firmware/model/obstacle.h"

#include <algorithm>
#include <cmath>

namespace sidestep {

Obstacle transformed(const Eigen::Isometry3d& b_from_a, const Obstacle& obstacle) {
  Obstacle seen = obstacle;
  seen.capsule.start = b_from_a * obstacle.capsule.start;
  seen.capsule.end = b_from_a * obstacle.capsule.end;
  seen.half_width_m = b_from_a.linear() * obstacle.half_width_m;
  seen.velocity_mps = b_from_a.linear() * obstacle.velocity_mps;
  seen.mean_velocity_mps = b_from_a.linear() * obstacle.mean_velocity_mps;
  seen.lead_mps = b_from_a.linear() * obstacle.lead_mps;
  seen.angular_velocity_radps = b_from_a.linear() * obstacle.angular_velocity_radps;
  return seen;
}

Obstacle sphere_obstacle(const Vector3& centre, double radius_m) {
  Obstacle sphere;
  sphere.capsule = {centre, centre, radius_m};
  return sphere;
}

Obstacle capsule_obstacle(const Vector3& centre, const Matrix3& rotation, double radius_m, double length_m) {
  const Vector3 half = rotation * Vector3(0, 0, 0.5 * length_m);
  Obstacle rod;
  rod.shape = Shape::kCapsule;
  rod.capsule = {centre - half, centre + half, radius_m};
  return rod;
}

Obstacle cylinder_obstacle(const Vector3& centre, const Matrix3& rotation, double radius_m, double height_m) {
  const double disc_m = 2e-6;
  if (height_m < disc_m) return sphere_obstacle(centre, radius_m);
  Obstacle cylinder = capsule_obstacle(centre, rotation, radius_m, height_m);
  cylinder.shape = Shape::kCylinder;
  cylinder.half_thickness_m = radius_m;
  return cylinder;
}

Obstacle box_obstacle(const Vector3& centre, const Matrix3& rotation, const Vector3& edges_m) {
  std::array<int, 3> axes{0, 1, 2};  // from the longest edge to the shortest
  std::stable_sort(axes.begin(), axes.end(), [&](int a, int b) { return edges_m[a] > edges_m[b]; });
  const Vector3 half = 0.5 * Vector3(edges_m[axes[0]], edges_m[axes[1]], edges_m[axes[2]]);
  const Vector3 half_length = half[0] * rotation.col(axes[0]);
  Obstacle box;
  box.capsule = {centre - half_length, centre + half_length, std::hypot(half[1], half[2])};
  const double line_m = 1e-6;  // a thinner box is stored as its enclosing capsule
  box.shape = half[1] < line_m ? Shape::kCapsule : Shape::kBox;
  if (box.shape == Shape::kCapsule) return box;
  box.half_width_m = half[1] * rotation.col(axes[1]);
  box.half_thickness_m = half[2];
  return box;
}

Box box_of(const Obstacle& obstacle) {
  const Vector3 half_length = 0.5 * (obstacle.capsule.end - obstacle.capsule.start);
  const double half_length_m = half_length.norm(), half_width_m = obstacle.half_width_m.norm();
  Box box{obstacle.capsule.centre(), {}, {half_length_m, half_width_m, obstacle.half_thickness_m}};
  box.axes.col(0) = half_length / half_length_m;
  box.axes.col(1) = obstacle.half_width_m / half_width_m;
  box.axes.col(2) = box.axes.col(0).cross(box.axes.col(1));
  return box;
}

ConvexSolid solid_of(const Obstacle& obstacle) {
  if (obstacle.shape == Shape::kBox) return ConvexSolid::of(box_of(obstacle), inflation_m(obstacle));
  if (obstacle.shape != Shape::kCylinder) return ConvexSolid::of(obstacle.capsule);
  return ConvexSolid::cylinder(obstacle.capsule.start, obstacle.capsule.end, obstacle.half_thickness_m,
                               inflation_m(obstacle));
}

double inflation_m(const Obstacle& obstacle) {
  return obstacle.capsule.radius_m - std::hypot(obstacle.half_width_m.norm(), obstacle.half_thickness_m);
}

Vector3 velocity_at(const Obstacle& obstacle, const Vector3& point) {
  return obstacle.velocity_mps + obstacle.angular_velocity_radps.cross(point - obstacle.capsule.centre());
}

Obstacle extrapolated(const Obstacle& obstacle, double dt_s) {
  Obstacle later = obstacle;
  Capsule& capsule = later.capsule;
  const Vector3 shift = obstacle.velocity_mps * dt_s;
  const Vector3 turn = obstacle.angular_velocity_radps * dt_s;
  if (capsule.is_sphere() || turn.squaredNorm() == 0.0) {
    capsule.start += shift;
    capsule.end += shift;
    return later;
  }
  const Matrix3 rotation = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  const Vector3 centre = obstacle.capsule.centre();
  const Vector3 half = rotation * (capsule.end - centre);
  capsule.start = centre - half + shift;
  capsule.end = centre + half + shift;
  later.half_width_m = rotation * obstacle.half_width_m;
  return later;
}

}  // namespace sidestep
