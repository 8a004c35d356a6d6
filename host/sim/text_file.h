#pragma once

#include <string>

namespace sidestep::sim {

/// The whole content. Throws std::runtime_error naming the file when it is not a regular file or cannot be read.
std::string read_text_file(const std::string& file);

}  // namespace sidestep::sim
