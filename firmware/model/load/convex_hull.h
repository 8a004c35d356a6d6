#pragma once

#include <array>
#include <vector>

#include "firmware/model/convex_solid.h"

namespace sidestep {

/// The convex hull of points, m. The triangles are those of its faces: three indices of vertices each.
struct ConvexHull {
  struct Face {
    std::array<int, 3> corners;
    Vector3 normal;   ///< unit, outward
    double offset_m;  ///< normal . p <= offset_m for all points p of the hull
  };
  std::vector<Vector3> vertices;
  std::vector<Face> faces;
  double volume_m3 = 0.0;

  /// The largest distance of p from the plane of a face, m: negative inside; outside at most the distance to the hull.
  double outside_m(const Vector3& p) const;
};

/// By Qhull. Points of one plane or line, or a single point, are thickened by 0.05 mm.
ConvexHull convex_hull(const std::vector<Vector3>& points);

Polyhedron polyhedron_of(const ConvexHull& hull);

}  // namespace sidestep
