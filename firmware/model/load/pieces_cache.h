#pragma once

#include "firmware/model/load/mesh_pieces.h"

namespace sidestep {

/// split_mesh() with a cache on disk, in $XDG_CACHE_HOME/sidestep, else ~/.cache/sidestep. The key is a hash of the
/// mesh and `most`. A damaged entry is computed and written again. Without a writable folder nothing is stored.
MeshPieces split_mesh_cached(const Mesh& mesh, int most);

}  // namespace sidestep
