#include <sched.h>
#include <unistd.h>

#include <filesystem>

#include "firmware/base/realtime.h"
#include "firmware/foresight/foresight_thread.h"
#include "firmware/io/blackbox/blackbox.h"
#include "tests/support/check.h"

using namespace sidestep;

namespace {

/// The threads of this process besides the calling one, by scheduler: SCHED_OTHER, and all.
struct Threads {
  int normal = 0, all = 0;
};

Threads other_threads() {
  Threads threads;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/task")) {
    const int id = std::stoi(entry.path().filename());
    if (id == getpid()) continue;
    ++threads.all;
    threads.normal += sched_getscheduler(id) == SCHED_OTHER;
  }
  return threads;
}

/// Threads inherit the scheduler of the thread that starts them.
void background_threads_have_no_realtime_priority(void**) {
  const Config config = load_config("firmware/config/lwa3.yaml", {"sidestep", "", "", ""});
  std::string why_not;
  if (!use_fifo(1, why_not)) {
    print_message("FIFO scheduling: %s\n", why_not.c_str());
    _skip(__FILE__, __LINE__);
  }
  std::atomic<bool> requested{false};
  Threads threads;
  {
    const Blackbox blackbox(config, requested);
    const ForesightThread foresight(config.model, false);
    for (int attempt = 0; attempt < 200 && threads.normal < 2; ++attempt) {
      sleep_until(monotonic_s() + 0.01);
      threads = other_threads();
    }
  }
  use_normal_scheduler();
  check(threads.all >= 2 && threads.normal == threads.all, "%d of %d threads", threads.normal, threads.all);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {cmocka_unit_test(background_threads_have_no_realtime_priority)};
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
