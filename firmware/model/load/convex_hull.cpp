#include "firmware/model/load/convex_hull.h"

#include <libqhullcpp/Qhull.h>
#include <libqhullcpp/QhullFacetList.h>
#include <libqhullcpp/QhullVertexSet.h>

#include <algorithm>
#include <limits>
#include <map>
#include <set>

namespace sidestep {
namespace {

constexpr double kThickening_m = 5e-5;
constexpr double kSameNormal = 1.0 - 1e-12;

ConvexHull run_qhull(const std::vector<Vector3>& points) {
  orgQhull::Qhull qhull;
  qhull.runQhull("", 3, static_cast<int>(points.size()), points.front().data(), "Qt");
  ConvexHull hull;
  hull.volume_m3 = qhull.volume();
  std::map<int, int> index_of;  // Qhull's index of a point to that of a vertex
  for (const orgQhull::QhullFacet& facet : qhull.facetList()) {
    ConvexHull::Face face{{}, Vector3(facet.hyperplane().coordinates()), -facet.hyperplane().offset()};
    const orgQhull::QhullVertexSet corners = facet.vertices();
    for (int i = 0; i < 3; ++i) {
      const int point = corners[i].point().id();
      const auto [entry, is_new] = index_of.emplace(point, static_cast<int>(hull.vertices.size()));
      if (is_new) hull.vertices.push_back(points[static_cast<size_t>(point)]);
      face.corners[static_cast<size_t>(i)] = entry->second;
    }
    hull.faces.push_back(face);
  }
  return hull;
}

std::vector<Vector3> thickened(const std::vector<Vector3>& points) {
  std::vector<Vector3> thick;
  for (const Vector3& p : points)
    for (int axis = 0; axis < 3; ++axis)
      for (const double side : {-kThickening_m, kThickening_m}) thick.push_back(p + side * Vector3::Unit(axis));
  return thick;
}

}  // namespace

double ConvexHull::outside_m(const Vector3& p) const {
  double largest_m = -std::numeric_limits<double>::infinity();
  for (const Face& face : faces) largest_m = std::max(largest_m, face.normal.dot(p) - face.offset_m);
  return largest_m;
}

ConvexHull convex_hull(const std::vector<Vector3>& points) {
  try {
    return run_qhull(points);
  } catch (const orgQhull::QhullError&) {
    return run_qhull(thickened(points));
  }
}

Polyhedron polyhedron_of(const ConvexHull& hull) {
  std::vector<std::set<int>> neighbours(hull.vertices.size());
  Polyhedron polyhedron;
  for (const ConvexHull::Face& face : hull.faces) {
    for (const int corner : face.corners)
      for (const int other : face.corners)
        if (other != corner) neighbours[static_cast<size_t>(corner)].insert(other);
    const bool known = std::any_of(polyhedron.normals.begin(), polyhedron.normals.end(),
                                   [&](const Vector3& normal) { return normal.dot(face.normal) > kSameNormal; });
    if (!known) polyhedron.normals.push_back(face.normal);
  }
  polyhedron.vertices = hull.vertices;
  polyhedron.first_neighbour.push_back(0);
  for (const std::set<int>& others : neighbours) {
    polyhedron.neighbours.insert(polyhedron.neighbours.end(), others.begin(), others.end());
    polyhedron.first_neighbour.push_back(static_cast<int>(polyhedron.neighbours.size()));
  }
  return polyhedron;
}

}  // namespace sidestep
