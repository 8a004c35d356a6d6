#pragma once

#include <memory>
#include <string>

#include "firmware/io/lcm/fragment_assembly.h"
#include "firmware/io/lcm/lcm_url.h"

namespace sidestep {

/// The datagrams that arrive at a multicast group, in batches. All memory is allocated at the start. For one thread,
/// except lost_datagrams().
class UdpReceiver {
 public:
  /// Joins the group. Asks the kernel for a receive buffer of the group's size, else of kReceiveBufferBytes. Throws
  /// std::runtime_error when the network cannot be used.
  explicit UdpReceiver(const MulticastGroup& group);
  ~UdpReceiver();
  UdpReceiver(const UdpReceiver&) = delete;
  UdpReceiver& operator=(const UdpReceiver&) = delete;

  /// Waits for at most timeout_ms for a batch of datagrams unless some of the last batch are left. Returns whether
  /// there are any.
  bool wait(int timeout_ms);

  struct Datagram {
    Sender sender;
    Packet bytes;       ///< valid until the next wait()
    double received_s;  ///< when the kernel received it, monotonic clock; it may have waited here since then
  };
  /// The next datagram of the batch, in the order of arrival; null at its end.
  const Datagram* next();

  /// Datagrams that the kernel dropped because the receive buffer was full.
  int64_t lost_datagrams() const;

  /// The size of the receive buffer as sysctl net.core.rmem_max counts it: asked for, and granted by the kernel.
  int wanted_buffer_bytes() const { return wanted_buffer_bytes_; }
  int granted_buffer_bytes() const { return granted_buffer_bytes_; }

 private:
  struct Batch;
  void join(const MulticastGroup& group);

  int socket_ = -1;
  int wanted_buffer_bytes_ = 0, granted_buffer_bytes_ = 0;
  std::unique_ptr<Batch> batch_;
  double last_received_s_ = 0.0;
};

}  // namespace sidestep
