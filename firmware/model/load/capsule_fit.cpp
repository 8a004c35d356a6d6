#include "firmware/model/load/capsule_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "firmware/model/load/circle.h"

namespace sidestep {
namespace {

constexpr double kLeastRadius_m = 1e-4;
constexpr double kMargin_m = 1e-9;  // added to radii; more than the rounding error
constexpr int kDirections = 300;    // in which the outermost points are sought

/// n unit vectors, evenly distributed over the part of the sphere above lowest_z (0: half of it, -1: all of it), on a
/// Fibonacci spiral.
std::vector<Vector3> directions(int n, double lowest_z) {
  std::vector<Vector3> found;
  for (int i = 0; i < n; ++i) {
    const double z = 1.0 - (1.0 - lowest_z) * (i + 0.5) / n, r = std::sqrt(1.0 - z * z);
    const double turn_rad = i * M_PI * (3.0 - std::sqrt(5.0));
    found.emplace_back(r * std::cos(turn_rad), r * std::sin(turn_rad), z);
  }
  return found;
}

/// The least capsule with a given axis direction: its radius is that of the smallest circle around the points'
/// projection along the axis, and its ends are as near to each other as the round caps allow.
Capsule capsule_along(const Vector3& axis, const std::vector<Vector3>& points) {
  const Vector3 u = axis.unitOrthogonal(), v = axis.cross(u);
  std::vector<Eigen::Vector2d> projection;
  projection.reserve(points.size());
  for (const Vector3& p : points) projection.emplace_back(u.dot(p), v.dot(p));
  const Circle circle = circle_around(projection);
  const double radius_m = std::max(circle.radius_m, kLeastRadius_m);
  const double infinity = std::numeric_limits<double>::infinity();
  double lower_m = infinity, upper_m = -infinity;
  for (size_t i = 0; i < points.size(); ++i) {
    const double along_m = axis.dot(points[i]);
    const double cap_m = std::sqrt(std::max(0.0, radius_m * radius_m - (projection[i] - circle.centre).squaredNorm()));
    lower_m = std::min(lower_m, along_m + cap_m);
    upper_m = std::max(upper_m, along_m - cap_m);
  }
  if (lower_m > upper_m) lower_m = upper_m = 0.5 * (lower_m + upper_m);
  const Vector3 middle = circle.centre.x() * u + circle.centre.y() * v;
  return {middle + lower_m * axis, middle + upper_m * axis, radius_m + kMargin_m};
}

double volume_m3(const Capsule& capsule) {
  const double r = capsule.radius_m;
  return M_PI * r * r * ((capsule.end - capsule.start).norm() + 4.0 / 3.0 * r);
}

/// The points that lie farthest in one of kDirections directions; the search for the axis uses only these.
std::vector<Vector3> outermost(const std::vector<Vector3>& points) {
  std::vector<size_t> chosen;
  for (const Vector3& direction : directions(kDirections, -1.0)) {
    size_t best = 0;
    for (size_t i = 1; i < points.size(); ++i)
      if (direction.dot(points[i]) > direction.dot(points[best])) best = i;
    chosen.push_back(best);
  }
  std::sort(chosen.begin(), chosen.end());
  chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
  std::vector<Vector3> found;
  found.reserve(chosen.size());
  for (size_t i : chosen) found.push_back(points[i]);
  return found;
}

}  // namespace

Capsule capsule_around(const std::vector<Vector3>& points) {
  const std::vector<Vector3> outer = outermost(points);
  Vector3 axis = Vector3::UnitZ();
  double least_m3 = std::numeric_limits<double>::infinity();
  const auto consider = [&](const Vector3& candidate) {
    const double candidate_m3 = volume_m3(capsule_along(candidate, outer));
    if (candidate_m3 < least_m3) least_m3 = candidate_m3, axis = candidate;
  };
  for (int i = 0; i < 3; ++i) consider(Vector3::Unit(i));
  for (const Vector3& direction : directions(100, 0.0)) consider(direction);
  double step = 0.1;
  for (int round = 0; round < 10; ++round, step *= 0.6) {
    const Vector3 u = axis.unitOrthogonal(), v = axis.cross(u);
    std::array<Vector3, 8> around;
    for (int i = 0; i < 8; ++i)
      around[i] = (axis + step * (std::cos(i * M_PI_4) * u + std::sin(i * M_PI_4) * v)).normalized();
    for (const Vector3& direction : around) consider(direction);
  }
  return capsule_along(axis, points);
}

}  // namespace sidestep
