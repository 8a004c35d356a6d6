#pragma once

#include <string>

namespace sidestep {

/// The whole content. Throws std::runtime_error with one line that names the file when it cannot be read or is larger
/// than any text a person or a generator writes, as what has no end is.
std::string read_text_file(const std::string& file);

}  // namespace sidestep
