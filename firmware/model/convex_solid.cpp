#include "firmware/model/convex_solid.h"

#include <cmath>

namespace sidestep {
namespace {

/// Climbs along the edges: a vertex without a better neighbour is the best of a convex polyhedron.
int farthest_vertex(const Polyhedron& polyhedron, const Vector3& direction, int vertex) {
  double best = direction.dot(polyhedron.vertices[static_cast<size_t>(vertex)]);
  for (bool climbs = true; climbs;) {
    climbs = false;
    const size_t from = static_cast<size_t>(vertex);
    for (int i = polyhedron.first_neighbour[from]; i < polyhedron.first_neighbour[from + 1]; ++i) {
      const int candidate = polyhedron.neighbours[static_cast<size_t>(i)];
      const double value = direction.dot(polyhedron.vertices[static_cast<size_t>(candidate)]);
      if (!(value > best)) continue;
      best = value;
      vertex = candidate;
      climbs = true;
    }
  }
  return vertex;
}

}  // namespace

ConvexSolid ConvexSolid::of(const Capsule& capsule) {
  ConvexSolid solid;
  solid.kind = capsule.is_sphere() ? CoreKind::kPoint : CoreKind::kSegment;
  solid.half_m = 0.5 * (capsule.end - capsule.start);
  solid.radius_m = capsule.radius_m;
  solid.centre = capsule.centre();
  return solid;
}

ConvexSolid ConvexSolid::of(const Box& box, double radius_m) {
  ConvexSolid solid;
  solid.kind = CoreKind::kBox;
  solid.half_m = box.half_m;
  solid.radius_m = radius_m;
  solid.rotation = box.axes;
  solid.centre = box.centre;
  return solid;
}

ConvexSolid ConvexSolid::cylinder(const Vector3& start, const Vector3& end, double core_radius_m, double radius_m) {
  ConvexSolid solid;
  solid.kind = CoreKind::kCylinder;
  const Vector3 axis = end - start;
  const double height_m = axis.norm();
  solid.half_m = {core_radius_m, core_radius_m, 0.5 * height_m};
  solid.radius_m = radius_m;
  solid.rotation.col(2) = axis / height_m;
  solid.rotation.col(0) = solid.rotation.col(2).unitOrthogonal();
  solid.rotation.col(1) = solid.rotation.col(2).cross(solid.rotation.col(0));
  solid.centre = 0.5 * (start + end);
  return solid;
}

Vector3 support(const ConvexSolid& solid, const Vector3& direction, int& vertex) {
  const Vector3& half = solid.half_m;
  switch (solid.kind) {
    case CoreKind::kPoint:
      return Vector3::Zero();
    case CoreKind::kSegment:
      return direction.dot(half) >= 0.0 ? half : Vector3(-half);
    case CoreKind::kBox:
      return {std::copysign(half.x(), direction.x()), std::copysign(half.y(), direction.y()),
              std::copysign(half.z(), direction.z())};
    case CoreKind::kCylinder: {
      const double across = std::sqrt(direction.x() * direction.x() + direction.y() * direction.y());
      const double scale = across > 0.0 ? half.x() / across : 0.0;
      return {direction.x() * scale, direction.y() * scale, std::copysign(half.z(), direction.z())};
    }
    case CoreKind::kPolyhedron:
      vertex = farthest_vertex(*solid.polyhedron, direction, vertex);
      return solid.polyhedron->vertices[static_cast<size_t>(vertex)];
  }
  return Vector3::Zero();
}

Vector3 extreme_point(const ConvexSolid& solid, const Vector3& direction) {
  int vertex = 0;
  return solid.centre + solid.rotation * support(solid, solid.rotation.transpose() * direction, vertex);
}

}  // namespace sidestep
