#include "firmware/io/loop/service_watchdog.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstddef>
#include <cstdlib>
#include <string>

namespace sidestep {
namespace {

constexpr double kInterval_s = 0.5;

}  // namespace

ServiceWatchdog::ServiceWatchdog() {
  const char* variable = std::getenv("NOTIFY_SOCKET");
  const std::string path = variable ? variable : "";
  sockaddr_un address{};
  if (path.empty() || path.size() >= sizeof address.sun_path) return;
  address.sun_family = AF_UNIX;
  path.copy(address.sun_path, path.size());
  if (path[0] == '@') address.sun_path[0] = 0;  // in the abstract namespace
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + path.size());
  socket_ = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (socket_ >= 0 && connect(socket_, reinterpret_cast<const sockaddr*>(&address), size) == 0) return;
  if (socket_ >= 0) close(socket_);
  socket_ = -1;
}

ServiceWatchdog::~ServiceWatchdog() {
  if (socket_ >= 0) close(socket_);
}

void ServiceWatchdog::report(int64_t cycles, double now_s) {
  if (socket_ < 0 || cycles == cycles_ || now_s - reported_s_ < kInterval_s) return;
  const std::string text = cycles_ == 0 ? "READY=1\nWATCHDOG=1" : "WATCHDOG=1";
  if (send(socket_, text.data(), text.size(), MSG_DONTWAIT | MSG_NOSIGNAL) < 0) return;
  cycles_ = cycles;
  reported_s_ = now_s;
}

}  // namespace sidestep
