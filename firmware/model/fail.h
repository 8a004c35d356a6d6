#pragma once

#include <fmt/format.h>

#include <stdexcept>
#include <utility>

namespace sidestep {

/// Throws std::runtime_error with a formatted line. For start-up.
template <typename... Args>
[[noreturn]] void fail(fmt::format_string<Args...> format, Args&&... args) {
  throw std::runtime_error(fmt::format(format, std::forward<Args>(args)...));
}

}  // namespace sidestep
