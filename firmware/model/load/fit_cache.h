#pragma once

#include "firmware/model/load/capsule_fit.h"

namespace sidestep {

/// fit_capsules(), remembered on disk by what the mesh is and `most`: in $XDG_CACHE_HOME/sidestep, else
/// ~/.cache/sidestep. A broken entry is made anew; without a folder to write to nothing is remembered.
CapsuleFit fit_capsules_cached(const Mesh& mesh, int most);

}  // namespace sidestep
