#include "host/campaign/parallel.h"

#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace sidestep::campaign {

void run_parallel(size_t count, int jobs, const std::atomic<bool>& stop, const std::function<void(size_t)>& task) {
  std::atomic<size_t> next{0};
  std::atomic<bool> failed{false};
  std::mutex mutex;
  std::exception_ptr error;
  const auto run_tasks = [&] {
    for (size_t i; (i = next++) < count && !stop && !failed;) {
      try {
        task(i);
      } catch (...) {
        const std::lock_guard<std::mutex> lock(mutex);
        if (!error) error = std::current_exception();
        failed = true;
      }
    }
  };
  std::vector<std::thread> threads;
  for (int i = 1; i < jobs; ++i) threads.emplace_back(run_tasks);
  run_tasks();
  for (std::thread& thread : threads) thread.join();
  if (error) std::rethrow_exception(error);
}

}  // namespace sidestep::campaign
