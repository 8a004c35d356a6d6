#include "firmware/model/load/mesh_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "firmware/model/nearest_points.h"

namespace sidestep {
namespace {

constexpr int kLeaf = 4;

/// To the plane of the triangle if the projection of p is inside, else to the nearest edge.
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

}  // namespace

MeshDistance::MeshDistance(const Mesh& mesh) : mesh_(mesh), triangles_(mesh.triangles.size()), nodes_(1) {
  std::iota(triangles_.begin(), triangles_.end(), 0);
  build(0, 0, static_cast<int>(triangles_.size()));
}

/// Halves the triangles along the longest edge of their box until a few are left.
void MeshDistance::build(int node, int first, int count) {
  const auto corner = [&](int triangle, size_t i) -> const Vector3& {
    return mesh_.vertices[static_cast<size_t>(mesh_.triangles[static_cast<size_t>(triangle)][i])];
  };
  Vector3 lower = Vector3::Constant(std::numeric_limits<double>::infinity()), upper = -lower;
  for (int i = first; i < first + count; ++i)
    for (size_t k = 0; k < 3; ++k) {
      lower = lower.cwiseMin(corner(triangles_[static_cast<size_t>(i)], k));
      upper = upper.cwiseMax(corner(triangles_[static_cast<size_t>(i)], k));
    }
  if (count <= kLeaf) {
    nodes_[static_cast<size_t>(node)] = {lower, upper, first, count};
    return;
  }
  int axis = 0;
  (upper - lower).maxCoeff(&axis);
  const auto along = [&](int t) { return corner(t, 0)[axis] + corner(t, 1)[axis] + corner(t, 2)[axis]; };
  const auto begin = triangles_.begin() + first;
  std::nth_element(begin, begin + count / 2, begin + count, [&](int a, int b) { return along(a) < along(b); });
  const int children = static_cast<int>(nodes_.size());
  nodes_.resize(nodes_.size() + 2);
  nodes_[static_cast<size_t>(node)] = {lower, upper, children, 0};
  build(children, first, count / 2);
  build(children + 1, first + count / 2, count - count / 2);
}

double MeshDistance::box_distance_m(const Node& node, const Vector3& p) const {
  return (p - p.cwiseMax(node.lower).cwiseMin(node.upper)).norm();
}

void MeshDistance::search(int index, const Vector3& p, double& least_m) const {
  const Node& node = nodes_[static_cast<size_t>(index)];
  for (int i = node.first; i < node.first + node.count; ++i) {
    const auto& [a, b, c] = mesh_.triangles[static_cast<size_t>(triangles_[static_cast<size_t>(i)])];
    least_m = std::min(least_m, distance_to_triangle_m(p, mesh_.vertices[static_cast<size_t>(a)],
                                                       mesh_.vertices[static_cast<size_t>(b)],
                                                       mesh_.vertices[static_cast<size_t>(c)]));
  }
  if (node.count > 0) return;
  const double first_m = box_distance_m(nodes_[static_cast<size_t>(node.first)], p);
  const double second_m = box_distance_m(nodes_[static_cast<size_t>(node.first) + 1], p);
  const int nearer = first_m <= second_m ? node.first : node.first + 1;
  if (std::min(first_m, second_m) < least_m) search(nearer, p, least_m);
  if (std::max(first_m, second_m) < least_m) search(2 * node.first + 1 - nearer, p, least_m);
}

double MeshDistance::to_m(const Vector3& p) const {
  double least_m = std::numeric_limits<double>::infinity();
  search(0, p, least_m);
  return least_m;
}

}  // namespace sidestep
