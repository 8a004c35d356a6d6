#pragma once

#include <chrono>
#include <cstdint>

namespace sidestep::sim {

/// CLOCK_MONOTONIC, microseconds.
inline int64_t monotonic_us() {
  const auto since_boot = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::microseconds>(since_boot).count();
}

}  // namespace sidestep::sim
