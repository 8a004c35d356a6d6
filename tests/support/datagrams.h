#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "tests/support/messages.h"

namespace sidestep::test {

/// LCM's datagrams, right or wrong.

inline void append_big_endian(Bytes& bytes, uint64_t value, int count) {
  for (int i = count - 1; i >= 0; --i) bytes.push_back(static_cast<uint8_t>(value >> (8 * i)));
}

inline void append(Bytes& bytes, const Bytes& more) {
  bytes.insert(bytes.end(), more.begin(), more.end());
}

/// Channel name and 0.
inline Bytes named(const std::string& channel, const Bytes& data) {
  Bytes bytes(channel.begin(), channel.end());
  bytes.push_back(0);
  append(bytes, data);
  return bytes;
}

/// body: channel, 0 and data.
inline Bytes short_datagram(const Bytes& body, uint32_t magic = 0x4c433032) {
  Bytes bytes;
  append_big_endian(bytes, magic, 4);
  append_big_endian(bytes, 7, 4);  // sequence number
  append(bytes, body);
  return bytes;
}

/// body: data, in the first fragment after channel and 0.
struct Fragment {
  uint32_t sequence = 0, message_bytes = 0, offset = 0, number = 0, count = 0;
  Bytes body;

  Bytes datagram() const {
    Bytes bytes;
    append_big_endian(bytes, 0x4c433033, 4);
    for (const uint32_t field : {sequence, message_bytes, offset}) append_big_endian(bytes, field, 4);
    for (const uint32_t field : {number, count}) append_big_endian(bytes, field, 2);
    append(bytes, body);
    return bytes;
  }
};

/// The fragments of a message whose data is cut at these places, which increase.
inline std::vector<Fragment> fragments(const std::string& channel, uint32_t sequence, const Bytes& data,
                                       std::vector<size_t> cuts) {
  cuts.insert(cuts.begin(), 0);
  cuts.push_back(data.size());
  std::vector<Fragment> all;
  for (size_t i = 0; i + 1 < cuts.size(); ++i) {
    const auto from = data.begin() + static_cast<std::ptrdiff_t>(cuts[i]);
    const Bytes part(from, data.begin() + static_cast<std::ptrdiff_t>(cuts[i + 1]));
    all.push_back({sequence, static_cast<uint32_t>(data.size()), static_cast<uint32_t>(cuts[i]),
                   static_cast<uint32_t>(i), static_cast<uint32_t>(cuts.size() - 1), i ? part : named(channel, part)});
  }
  return all;
}

}  // namespace sidestep::test
