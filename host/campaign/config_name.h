#pragma once

#include <string>

namespace sidestep::campaign {

/// The name by which find_file() (firmware/base/find_file.h) finds a configuration of the project: the one it has in
/// the source tree or else the one it is installed under. Throws std::runtime_error when it finds neither.
std::string config_name(const std::string& in_source_tree);

}  // namespace sidestep::campaign
