#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/io/lcm/packet.h"

namespace sidestep {

/// Checks on the bytes of a message that come before its generated decoder, which is not safe on hostile bytes.

constexpr size_t kFingerprintBytes = 8;
constexpr size_t kHeaderBytes = kFingerprintBytes + 8;  // fingerprint, utime
constexpr size_t kCountBytes = 4;
constexpr size_t kObstacleBytes = 4 + 1 + 16 * 8 + 1;  // obstacle_t; a unit test compares it with the generated type

inline uint64_t big_endian(const void* bytes, int count) {
  uint64_t value = 0;
  for (int i = 0; i < count; ++i) value = value << 8 | static_cast<const uint8_t*>(bytes)[i];
  return value;
}

/// The utime of a message that starts with one; 0 when there are too few bytes.
inline int64_t utime_of(Packet packet) {
  if (packet.size < kHeaderBytes) return 0;
  return static_cast<int64_t>(big_endian(packet.bytes + kFingerprintBytes, 8));
}

/// The count that follows the header; -1 when there are too few bytes.
inline int64_t count_of(Packet packet) {
  if (packet.size < kHeaderBytes + kCountBytes) return -1;
  return static_cast<int32_t>(big_endian(packet.bytes + kHeaderBytes, kCountBytes));
}

template <typename Message>
bool has_fingerprint(Packet packet) {
  return packet.size >= kFingerprintBytes &&
         big_endian(packet.bytes, kFingerprintBytes) == static_cast<uint64_t>(Message::getHash());
}

/// Decodes a message whose body after the count is `bytes_each` bytes for each of its elements. The size must be exact.
template <typename Message>
bool decode_counted(Packet packet, size_t bytes_each, Message& message) {
  const int64_t count = count_of(packet);
  if (count < 0 || packet.size != kHeaderBytes + kCountBytes + bytes_each * static_cast<size_t>(count)) return false;
  return message.decode(packet.bytes, 0, static_cast<int>(packet.size)) >= 0;
}

}  // namespace sidestep
