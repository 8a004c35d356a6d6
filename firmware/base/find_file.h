#pragma once

#include <string>

namespace sidestep {

/// Whether a regular file has this path. False also where the system cannot look the path up, as one that is too long.
bool is_file(const std::string& path);

/// The folder that contains an absolute folder; empty for the root.
std::string folder_above(const std::string& folder);

/// The first existing file of this name in an absolute folder or in one of the folders above it; empty if none exists.
std::string find_upwards(const std::string& folder, const std::string& name);

/// The first existing file of this name, searched in this order: the folder of the file `reference` (empty: skipped)
/// and the folders above it; the working directory and the folders above it; share/sidestep below the folders above the
/// running program, then below those above the shared library that contains this code. Empty if no such file exists.
std::string find_file(const std::string& name, const std::string& reference = "");

}  // namespace sidestep
