#pragma once

#include <cstdint>
#include <string>

namespace sidestep {

/// What the receiving side needs to know of an LCM network.
struct MulticastGroup {
  uint32_t address = 0;  ///< host byte order
  uint16_t port = 0;
  int receive_buffer_bytes = 0;  ///< 0: not specified
};

/// The URL itself; where it is empty LCM_DEFAULT_URL, else LCM's default, udpm://239.255.76.67:7667?ttl=0.
std::string lcm_url_or_default(const std::string& url);

/// Reads "udpm://ADDRESS:PORT?ttl=N&recv_buf_size=N"; without ADDRESS:PORT that of LCM's default. Throws
/// std::runtime_error for everything else: LCM's other providers do not receive over UDP multicast.
MulticastGroup multicast_group_of(const std::string& url);

/// Throws std::runtime_error, with the URL and where it comes from, if multicast_group_of() refuses
/// lcm_url_or_default(url).
void check_lcm_url(const std::string& url);

}  // namespace sidestep
