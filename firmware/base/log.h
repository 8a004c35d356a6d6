#pragma once

#include <string>

namespace sidestep {

/// One line each on standard error. Not for the real-time cycle.
void log_info(const std::string& line);
void log_warning(const std::string& line);

}  // namespace sidestep
