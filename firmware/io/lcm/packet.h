#pragma once

#include <cstddef>
#include <cstdint>

namespace sidestep {

/// The bytes of a message, without ownership.
struct Packet {
  const uint8_t* bytes = nullptr;
  size_t size = 0;
};

}  // namespace sidestep
