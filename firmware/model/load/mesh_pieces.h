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

/// Cuts the surface by planes into at most `most` pieces, 1 to kMostPieces, each enclosed by its convex hull. The next
/// cut is the one that reduces the sum of the hulls' volumes most, among planes across the three axes. No more cuts
/// than bring the excess to 4.5 mm for 95 % of the surface and 10 mm at most.
MeshPieces split_mesh(const Mesh& mesh, int most);

}  // namespace sidestep
