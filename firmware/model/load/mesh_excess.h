#pragma once

#include "firmware/model/load/mesh_distance.h"
#include "firmware/model/load/mesh_pieces.h"

namespace sidestep {

/// Sets the excess of the pieces over a mesh from 6000 samples of the surface; the largest is searched from the largest
/// of these on, and exact to about 0.2 mm. hulls: those of the pieces' polyhedra. Returns the piece that has it.
size_t measure_excess(const std::vector<ConvexHull>& hulls, const MeshDistance& mesh, MeshPieces& pieces);

}  // namespace sidestep
