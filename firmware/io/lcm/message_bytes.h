#pragma once

#include <cstddef>
#include <cstdint>

namespace sidestep {

/// What can be read from the bytes of a message before any decoder is let near them.

constexpr size_t kHeaderBytes = 16;  // fingerprint and utime
constexpr size_t kCountBytes = 4;

inline uint64_t big_endian(const void* bytes, int count) {
  uint64_t value = 0;
  for (int i = 0; i < count; ++i) value = value << 8 | static_cast<const uint8_t*>(bytes)[i];
  return value;
}

/// The count that follows the header, or -1 when the bytes are too few to have one.
inline int64_t count_of(const void* bytes, size_t size) {
  if (size < kHeaderBytes + kCountBytes) return -1;
  return static_cast<int32_t>(big_endian(static_cast<const uint8_t*>(bytes) + kHeaderBytes, kCountBytes));
}

template <typename Message>
bool has_fingerprint(const void* bytes, size_t size) {
  return size >= 8 && big_endian(bytes, 8) == static_cast<uint64_t>(Message::getHash());
}

}  // namespace sidestep
