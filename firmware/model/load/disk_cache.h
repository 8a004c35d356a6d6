#pragma once

#include <optional>
#include <string>

namespace sidestep {

/// Results that take long to compute, in $XDG_CACHE_HOME/sidestep, else ~/.cache/sidestep. An entry is one line of text
/// below a file name; a hash detects damage. Without a readable or writable folder nothing is found or stored.
std::optional<std::string> read_cache(const std::string& name);
void write_cache(const std::string& name, const std::string& line);

}  // namespace sidestep
