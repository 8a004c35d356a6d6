#pragma once

#include <string>

namespace sidestep {

/// The whole content of a file of at most 16 MB (larger ones, such as /dev/zero, are no text). Throws
/// std::runtime_error with one line that names the file if the file cannot be read or is larger.
std::string read_text_file(const std::string& file);

}  // namespace sidestep
