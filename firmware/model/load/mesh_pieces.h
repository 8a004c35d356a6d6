#pragma once

#include <memory>

#include "firmware/model/capsule.h"
#include "firmware/model/load/convex_hull.h"
#include "firmware/model/load/mesh.h"

namespace sidestep {

constexpr int kMostPieces = 8;
constexpr int kMostVertices = 96;

/// A convex piece of a mesh: all points within radius_m of a polyhedron of at most kMostVertices vertices.
struct MeshPiece {
  std::shared_ptr<const Polyhedron> polyhedron;
  double radius_m = 0.0;
};

/// Convex pieces that together enclose a mesh, in the mesh's frame. Excess: distance to the mesh from a point of their
/// outer surface, m, at sampled points.
struct MeshPieces {
  std::vector<MeshPiece> pieces;
  double excess_p95_m = 0.0;  ///< 95 % of the surface have less
  double excess_m = 0.0;      ///< the largest
};

/// Covers a mesh by at most `most` convex pieces, 1 to kMostPieces: the fewest that bring the excess to 4.5 mm for 95 %
/// of the surface and 10 mm at most. The part with the largest excess is cut by the plane across one of the three axes
/// that reduces the hulls' volume most, until there are three times as many parts; then parts are merged in pairs.
MeshPieces split_mesh(const Mesh& mesh, int most);

}  // namespace sidestep
