#pragma once

#include <atomic>
#include <cstddef>
#include <functional>

namespace sidestep::campaign {

/// Calls task(0) ... task(count - 1) on `jobs` threads. When `stop` becomes true or a task throws, no other task
/// begins; the first exception is thrown after the running ones have ended.
void run_parallel(size_t count, int jobs, const std::atomic<bool>& stop, const std::function<void(size_t)>& task);

}  // namespace sidestep::campaign
