#pragma once

#include <cmath>
#include <cstdint>

namespace sidestep {

/// Reports to systemd that the loop runs, so that it restarts a controller whose loop hangs: sd_notify(3) without its
/// library. Does nothing where the environment has no NOTIFY_SOCKET.
class ServiceWatchdog {
 public:
  ServiceWatchdog();
  ~ServiceWatchdog();
  ServiceWatchdog(const ServiceWatchdog&) = delete;
  ServiceWatchdog& operator=(const ServiceWatchdog&) = delete;

  /// Reports at most every 0.5 s, and only when the loop has counted cycles since. The first report also says that the
  /// service has started. Does not wait.
  void report(int64_t cycles, double now_s);

 private:
  int socket_ = -1;
  int64_t cycles_ = 0;
  double reported_s_ = -HUGE_VAL;
};

}  // namespace sidestep
