#pragma once

#include <vector>

#include "firmware/model/box.h"
#include "firmware/model/capsule.h"

namespace sidestep {

/// A convex polyhedron, m, in a frame of its own.
struct Polyhedron {
  std::vector<Vector3> vertices;     ///< at least one
  std::vector<int> first_neighbour;  ///< of vertex i in `neighbours`; one more entry than vertices
  std::vector<int> neighbours;       ///< the vertices at the other ends of the edges of each vertex
  std::vector<Vector3> normals;      ///< of the faces, unit, outward
};

enum class CoreKind { kPoint, kSegment, kBox, kCylinder, kPolyhedron };

/// A convex core of any pose and all points within radius_m of it.
struct ConvexSolid {
  CoreKind kind = CoreKind::kPoint;
  /// In the core's frame. kSegment: from the centre to one end; kBox: half of each edge; kCylinder: radius, radius,
  /// half the height along z. Not used otherwise.
  Vector3 half_m = Vector3::Zero();
  const Polyhedron* polyhedron = nullptr;  ///< of kPolyhedron
  double radius_m = 0.0;
  Matrix3 rotation = Matrix3::Identity();  ///< base_from_core
  Vector3 centre = Vector3::Zero();        ///< origin of the core's frame, in the base frame

  static ConvexSolid of(const Capsule& capsule);
  static ConvexSolid of(const Box& box, double radius_m);
  /// The cylinder between two different points, and all points within radius_m of it.
  static ConvexSolid cylinder(const Vector3& start, const Vector3& end, double core_radius_m, double radius_m);
};

/// The core's point that lies farthest in a direction, both in the core's frame. vertex: where the search in a
/// polyhedron starts, and its result; 0 at first.
Vector3 support(const ConvexSolid& solid, const Vector3& direction, int& vertex);

/// The same with both in the base frame.
Vector3 extreme_point(const ConvexSolid& solid, const Vector3& direction);

}  // namespace sidestep
