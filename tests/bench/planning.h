#pragma once

#include <string>
#include <vector>

namespace sidestep::bench {

/// CPU time of the tree planner's first guide, ms, of each of the campaign's furniture families (`scenes` of each, seed
/// 1), for the arm of a configuration file. Infinite where no guide is found. The guide is a path that has been made
/// shorter and timed. Errors: as load_config().
std::vector<double> first_guides_ms(const std::string& config_path, int scenes);

}  // namespace sidestep::bench
