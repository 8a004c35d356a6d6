#pragma once

#include <string>
#include <vector>

#include "host/campaign/search/search.h"

namespace sidestep::campaign {

/// A scene and its witness.
struct ProvenScene {
  SearchScene scene;
  WitnessPath witness;
};

/// Scene and witness as YAML on one line. Numbers are read back as the same bits.
std::string to_yaml(const SearchScene& scene, const WitnessPath& witness);

/// Reads such a line from a file. Throws std::runtime_error, one line that names file and key.
ProvenScene load_proven_scene(const std::string& file);

/// One row per finding; the last column is to_yaml(). Throws std::runtime_error if the file cannot be written.
void write_findings(const std::string& file, const std::string& law, const std::vector<Finding>& findings);

}  // namespace sidestep::campaign
