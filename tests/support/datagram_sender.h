#pragma once

#include <string>

#include "tests/support/messages.h"

namespace sidestep::test {

/// Sends any bytes as a datagram to an LCM network.
class DatagramSender {
 public:
  explicit DatagramSender(const std::string& url);
  ~DatagramSender();
  DatagramSender(const DatagramSender&) = delete;
  DatagramSender& operator=(const DatagramSender&) = delete;

  void send(const Bytes& datagram);

 private:
  int socket_;
};

}  // namespace sidestep::test
