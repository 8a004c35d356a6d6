#include "firmware/model/load/capsule_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "firmware/model/load/circle.h"
#include "firmware/model/nearest_points.h"

namespace sidestep {
namespace {

constexpr double kLeastRadius_m = 1e-4;
constexpr double kMargin_m = 1e-9;        // added to radii; more than the rounding error
constexpr double kSlackLeftByCut = 0.75;  // a further cut must reduce the slack below this share
constexpr double kSlackAccepted_m = 0.01;
constexpr int kDirections = 300;  // in which the outermost points are sought

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

/// The part of the mesh between two planes across an axis, as the corners of its cut triangles.
std::vector<Vector3> slice(const Mesh& mesh, const Vector3& axis, double from_m, double to_m) {
  std::vector<Vector3> points;
  for (const Vector3& p : mesh.vertices)
    if (axis.dot(p) >= from_m && axis.dot(p) <= to_m) points.push_back(p);
  for (const auto& triangle : mesh.triangles)
    for (size_t corner = 0; corner < 3; ++corner) {
      const Vector3& a = mesh.vertices[static_cast<size_t>(triangle[corner])];
      const Vector3& b = mesh.vertices[static_cast<size_t>(triangle[(corner + 1) % 3])];
      for (double cut_m : {from_m, to_m}) {
        const double from_a_m = axis.dot(a) - cut_m, from_b_m = axis.dot(b) - cut_m;
        if (from_a_m * from_b_m < 0.0) points.push_back(a + from_a_m / (from_a_m - from_b_m) * (b - a));
      }
    }
  return points;
}

std::vector<Capsule> cut(const Mesh& mesh, const Vector3& axis, int slices) {
  double lower_m = std::numeric_limits<double>::infinity(), upper_m = -lower_m;
  for (const Vector3& p : mesh.vertices) {
    lower_m = std::min(lower_m, axis.dot(p));
    upper_m = std::max(upper_m, axis.dot(p));
  }
  std::vector<Capsule> capsules;
  const double each_m = (upper_m - lower_m) / slices;
  for (int i = 0; i < slices; ++i) {
    // The outermost planes are 1 m outside of the mesh, so that rounding cannot cut any of it off.
    const double from_m = i == 0 ? lower_m - 1.0 : lower_m + i * each_m;
    const double to_m = i + 1 == slices ? upper_m + 1.0 : lower_m + (i + 1) * each_m;
    const std::vector<Vector3> points = slice(mesh, axis, from_m, to_m);
    if (!points.empty()) capsules.push_back(capsule_around(points));
  }
  return capsules;
}

/// Distance from p to a triangle: to its plane if the projection of p is inside, else to the nearest edge.
double distance_to_triangle_m(const Vector3& p, const Vector3& a, const Vector3& b, const Vector3& c) {
  const Vector3 normal = (b - a).cross(c - a);
  const bool inside = normal.cross(b - a).dot(p - a) >= 0.0 && normal.cross(c - b).dot(p - b) >= 0.0 &&
                      normal.cross(a - c).dot(p - c) >= 0.0;
  if (inside && normal.squaredNorm() > 0.0) return std::abs(normal.normalized().dot(p - a));
  double least_m = std::numeric_limits<double>::infinity();
  for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)})
    least_m = std::min(least_m, (p - nearest_on_segment(from, to, p)).norm());
  return least_m;
}

double distance_m(const Vector3& p, const Mesh& mesh) {
  double least_m = std::numeric_limits<double>::infinity();
  for (const Vector3& vertex : mesh.vertices) least_m = std::min(least_m, (p - vertex).norm());
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vector3 &p_a = mesh.vertices[static_cast<size_t>(a)], &p_b = mesh.vertices[static_cast<size_t>(b)],
                  &p_c = mesh.vertices[static_cast<size_t>(c)];
    const double size_m = std::sqrt(std::max((p_b - p_a).squaredNorm(), (p_c - p_a).squaredNorm()));
    if ((p - p_a).norm() - size_m < least_m) least_m = std::min(least_m, distance_to_triangle_m(p, p_a, p_b, p_c));
  }
  return least_m;
}

/// Sample points on the surface of a capsule: on both caps and on the cylinder between them.
std::vector<Vector3> surface(const Capsule& capsule) {
  std::vector<Vector3> points;
  const Vector3 axis = capsule.end - capsule.start;
  for (const Vector3& direction : directions(60, -1.0)) {
    points.push_back((direction.dot(axis) < 0.0 ? capsule.start : capsule.end) + capsule.radius_m * direction);
    const Vector3 across = axis.cross(direction);
    if (across.norm() < 1e-9) continue;
    for (double along : {0.0, 0.25, 0.5, 0.75, 1.0})
      points.push_back(capsule.start + along * axis + capsule.radius_m * across.normalized());
  }
  if (axis.norm() > 0.0) {
    points.push_back(capsule.start - capsule.radius_m * axis.normalized());
    points.push_back(capsule.end + capsule.radius_m * axis.normalized());
  }
  return points;
}

double slack_m(const std::vector<Capsule>& capsules, const Mesh& mesh) {
  double largest_m = 0.0;
  for (const Capsule& capsule : capsules)
    for (const Vector3& p : surface(capsule)) {
      const bool inside_another = std::any_of(capsules.begin(), capsules.end(), [&](const Capsule& other) {
        return &other != &capsule && contains(other, {p, p, 0.0});
      });
      if (!inside_another) largest_m = std::max(largest_m, distance_m(p, mesh));
    }
  return largest_m;
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

CapsuleFit fit_capsules(const Mesh& mesh, int most) {
  CapsuleFit best;
  best.capsules = {capsule_around(mesh.vertices)};
  best.slack_m = slack_m(best.capsules, mesh);
  const Vector3 along = best.capsules.front().end - best.capsules.front().start;
  const Vector3 axis = along.norm() > kLeastRadius_m ? along.normalized() : Vector3(Vector3::UnitZ());
  for (int slices = 2; slices <= most && best.slack_m > kSlackAccepted_m; ++slices) {
    CapsuleFit candidate{cut(mesh, axis, slices), 0.0};
    candidate.slack_m = slack_m(candidate.capsules, mesh);
    if (candidate.slack_m < kSlackLeftByCut * best.slack_m) best = std::move(candidate);
  }
  return best;
}

}  // namespace sidestep
