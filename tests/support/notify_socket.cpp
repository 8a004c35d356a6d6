#include "tests/support/notify_socket.h"

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>

#include "tests/support/check.h"
#include "tests/support/scratch.h"

namespace sidestep::test {

NotifySocket::NotifySocket() : socket_(socket(AF_UNIX, SOCK_DGRAM, 0)) {
  static int count = 0;
  const std::string path = scratch_folder() + "/notify-" + std::to_string(++count);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  check(path.size() < sizeof address.sun_path, "%s is too long", path.c_str());
  path.copy(address.sun_path, path.size());
  check(bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0, "no socket");
  setenv("NOTIFY_SOCKET", path.c_str(), 1);
}

NotifySocket::~NotifySocket() {
  unsetenv("NOTIFY_SOCKET");
  close(socket_);
}

std::string NotifySocket::next(int limit_ms) const {
  pollfd readable{socket_, POLLIN, 0};
  if (poll(&readable, 1, limit_ms) <= 0) return "";
  std::string text(100, '\0');
  text.resize(static_cast<size_t>(std::max<ssize_t>(0, recv(socket_, text.data(), text.size(), 0))));
  return text;
}

}  // namespace sidestep::test
