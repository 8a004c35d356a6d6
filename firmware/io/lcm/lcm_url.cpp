#include "firmware/io/lcm/lcm_url.h"

#include <arpa/inet.h>

#include <climits>
#include <cstdlib>

#include "firmware/base/fail.h"

namespace sidestep {
namespace {

constexpr const char* kScheme = "udpm://";
constexpr const char* kDefaultGroup = "239.255.76.67:7667";

/// The text before the first of the separators; removes both from `text`.
std::string take_up_to(const char* separators, std::string& text) {
  const size_t at = text.find_first_of(separators);
  std::string part = text.substr(0, at);
  text.erase(0, at == std::string::npos ? at : at + 1);
  return part;
}

/// A number in C's notation, as liblcm reads it.
long number(const std::string& text, long least, long most, const char* what) {
  char* end = nullptr;
  const long value = std::strtol(text.c_str(), &end, 0);
  if (text.empty() || *end || value < least || value > most)
    fail("{} is '{}', not a number from {} to {}", what, text, least, most);
  return value;
}

}  // namespace

std::string lcm_url_or_default(const std::string& url) {
  if (!url.empty()) return url;
  const char* from_environment = std::getenv("LCM_DEFAULT_URL");
  return from_environment && *from_environment ? from_environment : fmt::format("{}{}?ttl=0", kScheme, kDefaultGroup);
}

MulticastGroup multicast_group_of(const std::string& url) {
  std::string rest = url;
  if (rest.rfind(kScheme, 0) != 0) fail("only {}ADDRESS:PORT is supported", kScheme);
  rest.erase(0, std::string(kScheme).size());

  std::string port = take_up_to("?", rest);
  if (port.empty()) port = kDefaultGroup;
  const std::string address = take_up_to(":", port);
  in_addr parsed{};
  if (inet_pton(AF_INET, address.c_str(), &parsed) != 1 || !IN_MULTICAST(ntohl(parsed.s_addr)))
    fail("'{}' is not a multicast address, 224.0.0.0 to 239.255.255.255", address);
  MulticastGroup group{ntohl(parsed.s_addr), static_cast<uint16_t>(number(port, 1, 65535, "the port")), 0};

  while (!rest.empty()) {
    std::string value = take_up_to("&,", rest);
    const std::string key = take_up_to("=", value);
    if (key == "ttl")
      number(value, 0, 255, "ttl");  // of what is sent; liblcm reads it
    else if (key == "recv_buf_size")
      group.receive_buffer_bytes = static_cast<int>(number(value, 1, INT_MAX / 2, "recv_buf_size"));
    else
      fail("unknown option '{}'", key);
  }
  return group;
}

void check_lcm_url(const std::string& url) {
  const std::string used = lcm_url_or_default(url);
  try {
    multicast_group_of(used);
  } catch (const std::exception& error) {
    fail("LCM network {}{}: {}", used, url.empty() ? " of LCM_DEFAULT_URL" : "", error.what());
  }
}

}  // namespace sidestep
