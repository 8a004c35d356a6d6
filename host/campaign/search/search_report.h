#pragma once

#include <string>

#include "host/campaign/search/search.h"

namespace sidestep::campaign {

/// The table of a search and, below it, every finding with its scene (finding_file.h).
std::string search_report(const SearchSpace& space, const std::string& law, const SearchResult& result);

/// One line about the run of a scene of finding_file.h and the clearance of its witness.
std::string scene_report(const SearchScene& scene, const ClosestApproach& closest, double witness_clearance_m);

}  // namespace sidestep::campaign
