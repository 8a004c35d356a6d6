#pragma once

#include <string>

namespace sidestep {

/// The first file of this name: in the folder of the file `beside` (empty: none) or one above it, in the working
/// directory or one above it, or in share/sidestep beside the bin/ or lib/ that this code runs from. Empty when there
/// is none.
std::string find_file(const std::string& name, const std::string& beside = "");

}  // namespace sidestep
