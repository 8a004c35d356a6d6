#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <stdexcept>
#include <string>
#include <utility>

namespace sidestep {

/// Throws std::runtime_error with a formatted message; for start-up only. Control characters (a name read from a file
/// may contain any) are replaced by spaces, so that the message is always one line.
template <typename... Args>
[[noreturn]] void fail(fmt::format_string<Args...> format, Args&&... args) {
  std::string line = fmt::format(format, std::forward<Args>(args)...);
  std::replace_if(
      line.begin(), line.end(), [](unsigned char c) { return std::iscntrl(c); }, ' ');
  throw std::runtime_error(line);
}

}  // namespace sidestep
