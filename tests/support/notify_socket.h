#pragma once

#include <string>

namespace sidestep::test {

/// The socket of a service manager, in the environment of this process and of those that it starts.
class NotifySocket {
 public:
  NotifySocket();
  ~NotifySocket();
  NotifySocket(const NotifySocket&) = delete;
  NotifySocket& operator=(const NotifySocket&) = delete;

  /// The next report; empty if there is none within limit_ms.
  std::string next(int limit_ms) const;

 private:
  int socket_;
};

}  // namespace sidestep::test
