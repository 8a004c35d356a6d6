#include "firmware/io/lcm/udp_receiver.h"

#include <linux/sock_diag.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "firmware/base/fail.h"
#include "firmware/base/realtime.h"

namespace sidestep {
namespace {

// Eight messages of 4096 obstacles from this machine: each takes 1 MB of twice this size.
constexpr int kReceiveBufferBytes = 4 << 20;

constexpr size_t kLargestDatagramBytes = 65536;
constexpr unsigned kBatch = 16;

template <typename Value>
bool set(int socket, int level, int option, const Value& value) {
  return setsockopt(socket, level, option, &value, sizeof value) == 0;
}

constexpr size_t kControlBytes = CMSG_SPACE(sizeof(timespec));

/// How long a datagram has waited since the kernel received it, s; 0 if that is unknown. The kernel's time stamps are
/// on the clock of wall_now_s: a jump of the system time makes the datagrams that wait at that moment older or younger.
double waited_s(msghdr& header, double wall_now_s) {
  for (cmsghdr* part = CMSG_FIRSTHDR(&header); part; part = CMSG_NXTHDR(&header, part)) {
    if (part->cmsg_level != SOL_SOCKET || part->cmsg_type != SCM_TIMESTAMPNS) continue;
    timespec stamp{};
    std::memcpy(&stamp, CMSG_DATA(part), sizeof stamp);
    const double received_s = static_cast<double>(stamp.tv_sec) + 1e-9 * static_cast<double>(stamp.tv_nsec);
    return std::max(0.0, wall_now_s - received_s);
  }
  return 0.0;
}

/// As the kernel counts it for the caller; it reserves the double for its own use.
int buffer_bytes(int socket) {
  int reserved = 0;
  socklen_t size = sizeof reserved;
  getsockopt(socket, SOL_SOCKET, SO_RCVBUF, &reserved, &size);
  return reserved / 2;
}

}  // namespace

struct UdpReceiver::Batch {
  std::array<std::array<uint8_t, kLargestDatagramBytes>, kBatch> bytes;
  std::array<sockaddr_in, kBatch> senders;
  std::array<iovec, kBatch> places;
  std::array<mmsghdr, kBatch> headers;
  alignas(cmsghdr) std::array<std::array<uint8_t, kControlBytes>, kBatch> controls;
  double now_s = 0.0, wall_now_s = 0.0;  // when the batch was taken, on both clocks
  unsigned count = 0, next = 0;
  Datagram datagram;

  Batch() : bytes(), senders(), places(), headers(), controls() {
    for (size_t i = 0; i < kBatch; ++i) {
      places[i] = {bytes[i].data(), bytes[i].size()};
      headers[i].msg_hdr.msg_name = &senders[i];
      headers[i].msg_hdr.msg_iov = &places[i];
      headers[i].msg_hdr.msg_iovlen = 1;
      headers[i].msg_hdr.msg_control = controls[i].data();
    }
  }
};

UdpReceiver::UdpReceiver(const MulticastGroup& group) : batch_(std::make_unique<Batch>()) {
  socket_ = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (socket_ < 0) fail("no UDP socket: {}", std::strerror(errno));
  wanted_buffer_bytes_ = group.receive_buffer_bytes > 0 ? group.receive_buffer_bytes : kReceiveBufferBytes;
  if (!set(socket_, SOL_SOCKET, SO_RCVBUFFORCE, wanted_buffer_bytes_))  // needs CAP_NET_ADMIN
    set(socket_, SOL_SOCKET, SO_RCVBUF, wanted_buffer_bytes_);
  granted_buffer_bytes_ = buffer_bytes(socket_);
  set(socket_, SOL_SOCKET, SO_TIMESTAMPNS, 1);
  try {
    join(group);
  } catch (...) {
    close(socket_);
    throw;
  }
}

UdpReceiver::~UdpReceiver() {
  close(socket_);
}

void UdpReceiver::join(const MulticastGroup& group) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(group.address);
  address.sin_port = htons(group.port);
  // Other LCM processes of this machine are bound to the same address.
  if (!set(socket_, SOL_SOCKET, SO_REUSEADDR, 1) ||
      bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
    fail("cannot bind its port: {}", std::strerror(errno));
  ip_mreq membership{};
  membership.imr_multiaddr = address.sin_addr;
  if (!set(socket_, IPPROTO_IP, IP_ADD_MEMBERSHIP, membership))
    fail("cannot join its group: {} (is there a multicast route?)", std::strerror(errno));
}

bool UdpReceiver::wait(int timeout_ms) {
  Batch& batch = *batch_;
  if (batch.next < batch.count) return true;
  batch.next = batch.count = 0;
  pollfd readable{socket_, POLLIN, 0};
  if (poll(&readable, 1, timeout_ms) <= 0) return false;
  for (mmsghdr& header : batch.headers) {
    header.msg_hdr.msg_namelen = sizeof(sockaddr_in);
    header.msg_hdr.msg_controllen = kControlBytes;
  }
  const int received = recvmmsg(socket_, batch.headers.data(), kBatch, MSG_DONTWAIT, nullptr);
  batch.now_s = monotonic_s();
  batch.wall_now_s = wall_s();
  if (received > 0) batch.count = static_cast<unsigned>(received);
  return received > 0;
}

const UdpReceiver::Datagram* UdpReceiver::next() {
  Batch& batch = *batch_;
  if (batch.next == batch.count) return nullptr;
  const unsigned i = batch.next++;
  const double received_s = batch.now_s - waited_s(batch.headers[i].msg_hdr, batch.wall_now_s);
  last_received_s_ = std::max(last_received_s_, received_s);  // the order of arrival
  batch.datagram = {{ntohl(batch.senders[i].sin_addr.s_addr), ntohs(batch.senders[i].sin_port)},
                    {batch.bytes[i].data(), batch.headers[i].msg_len},
                    last_received_s_};
  return &batch.datagram;
}

int64_t UdpReceiver::lost_datagrams() const {
  uint32_t counts[SK_MEMINFO_VARS] = {};
  socklen_t size = sizeof counts;
  getsockopt(socket_, SOL_SOCKET, SO_MEMINFO, counts, &size);
  return counts[SK_MEMINFO_DROPS];
}

}  // namespace sidestep
