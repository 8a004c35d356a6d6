#pragma once

#include <yaml-cpp/yaml.h>

#include <string>

namespace sidestep {

/// The one document of a text; null for an empty one. Throws YAML::Exception with the place where it is not valid, or
/// where a second document starts, which YAML::Load() would pass over in silence.
YAML::Node only_document(const std::string& text);

}  // namespace sidestep
