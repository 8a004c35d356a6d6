#pragma once

#include <cstddef>
#include <cstdint>

namespace sidestep {

/// FNV-1a, 64 bit: detects damaged records and names cache entries; no protection against a forger. To hash several
/// ranges as one, pass the hash of the ranges before as `hash`.
inline uint64_t fnv1a(const void* bytes, size_t size, uint64_t hash = 0xcbf29ce484222325u) {
  for (size_t i = 0; i < size; ++i) hash = (hash ^ static_cast<const unsigned char*>(bytes)[i]) * 0x100000001b3u;
  return hash;
}

}  // namespace sidestep
