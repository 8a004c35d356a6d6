#include "tests/support/datagram_sender.h"

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "firmware/io/lcm/lcm_url.h"
#include "tests/support/check.h"

namespace sidestep::test {

DatagramSender::DatagramSender(const std::string& url) : socket_(socket(AF_INET, SOCK_DGRAM, 0)) {
  const MulticastGroup group = multicast_group_of(url);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(group.address);
  address.sin_port = htons(group.port);
  const int ttl = 0;  // stays on this machine
  check(setsockopt(socket_, IPPROTO_IP, IP_MULTICAST_TTL, &ttl, sizeof ttl) == 0 &&
            connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0,
        "no socket to %s", url.c_str());
}

DatagramSender::~DatagramSender() {
  close(socket_);
}

void DatagramSender::send(const Bytes& datagram) {
  check(::send(socket_, datagram.data(), datagram.size(), 0) == static_cast<ssize_t>(datagram.size()), "not sent");
}

}  // namespace sidestep::test
