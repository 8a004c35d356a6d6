#include "firmware/io/loop/service_watchdog.h"

#include <cstdlib>

#include "tests/support/check.h"
#include "tests/support/notify_socket.h"

using namespace sidestep;
using test::NotifySocket;

namespace {

void a_running_loop_is_reported_at_intervals(void**) {
  const NotifySocket socket;
  ServiceWatchdog watchdog;
  watchdog.report(0, 9.9);
  assert_string_equal(socket.next(0).c_str(), "");  // no cycle yet
  for (int cycles = 1; cycles <= 150; ++cycles) watchdog.report(cycles, 10.0 + 0.01 * cycles);
  assert_string_equal(socket.next(0).c_str(), "READY=1\nWATCHDOG=1");
  assert_string_equal(socket.next(0).c_str(), "WATCHDOG=1");
  assert_string_equal(socket.next(0).c_str(), "WATCHDOG=1");
  assert_string_equal(socket.next(0).c_str(), "");
}

void a_loop_that_hangs_is_not_reported(void**) {
  const NotifySocket socket;
  ServiceWatchdog watchdog;
  watchdog.report(7, 10.0);
  assert_string_equal(socket.next(0).c_str(), "READY=1\nWATCHDOG=1");
  for (int i = 0; i < 100; ++i) watchdog.report(7, 11.0 + i);
  assert_string_equal(socket.next(0).c_str(), "");
}

void without_a_service_manager_nothing_happens(void**) {
  for (const char* path : {"", "/no/such/socket"}) {
    setenv("NOTIFY_SOCKET", path, 1);
    ServiceWatchdog().report(1, 1.0);
  }
  unsetenv("NOTIFY_SOCKET");
  ServiceWatchdog().report(1, 1.0);
}

/// A service manager that reads late must not stop the receiving thread.
void a_full_queue_does_not_block(void**) {
  const NotifySocket socket;
  ServiceWatchdog watchdog;
  for (int i = 1; i < 10000; ++i) watchdog.report(i, i);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_running_loop_is_reported_at_intervals),
      cmocka_unit_test(a_loop_that_hangs_is_not_reported),
      cmocka_unit_test(without_a_service_manager_nothing_happens),
      cmocka_unit_test(a_full_queue_does_not_block),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
