#pragma once

#include <string>
#include <vector>

#include "firmware/model/load/self_pairs.h"

namespace sidestep {

/// The file with the extension .srdf in place of .urdf, if it exists; else empty.
std::string srdf_beside(const std::string& urdf_file);

/// The pairs of links of all `disable_collisions` elements of an SRDF. Links may be unknown. Throws std::runtime_error,
/// one line that names the file, if it cannot be read or an element lacks one of its links.
std::vector<LinkPair> disabled_collisions(const std::string& srdf_file);

}  // namespace sidestep
