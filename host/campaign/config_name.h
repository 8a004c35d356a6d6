#pragma once

#include <string>

namespace sidestep::campaign {

/// The name under which find_file() (firmware/base/find_file.h) finds a configuration of the project: its name in the
/// source tree, or else its installed name. Throws std::runtime_error if neither exists.
std::string config_name(const std::string& in_source_tree);

}  // namespace sidestep::campaign
