#include "firmware/base/realtime.h"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <time.h>

#include <cerrno>
#include <cmath>
#include <cstring>

namespace sidestep {
namespace {

double seconds(clockid_t clock) {
  timespec now;
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// The part of the stack that is touched: more than the deepest call of the loop uses, far below a thread's stack limit.
constexpr size_t kStack_bytes = 512 * 1024;

// More than the threads and triple buffers take that are created after the memory is locked.
constexpr size_t kAllocatedLater_bytes = 128 << 20;

void touch_stack() {
  volatile char stack[kStack_bytes];
  for (size_t i = 0; i < kStack_bytes; i += 1024) stack[i] = 0;
  static_cast<void>(stack[0]);
}

/// Whether so many bytes more could be locked. With all memory locked, an allocation beyond the limit fails.
bool has_room(size_t bytes) {
  void* room = mmap(nullptr, bytes, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (room != MAP_FAILED) munmap(room, bytes);
  return room != MAP_FAILED;
}

}  // namespace

double monotonic_s() {
  return seconds(CLOCK_MONOTONIC);
}

double wall_s() {
  return seconds(CLOCK_REALTIME);
}

std::string utc_stamp() {
  timespec now;
  clock_gettime(CLOCK_REALTIME, &now);
  tm utc;
  gmtime_r(&now.tv_sec, &utc);
  char second[sizeof "20260131T235959"];
  strftime(second, sizeof second, "%Y%m%dT%H%M%S", &utc);
  const std::string microsecond = std::to_string(1000000 + now.tv_nsec / 1000).substr(1);
  return second + ("." + microsecond);
}

double thread_cpu_s() {
  return seconds(CLOCK_THREAD_CPUTIME_ID);
}

void sleep_until(double instant_s) {
  timespec until;
  until.tv_sec = static_cast<time_t>(std::floor(instant_s));
  until.tv_nsec = static_cast<long>((instant_s - std::floor(instant_s)) * 1e9);
  clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr);
}

bool lock_memory(std::string& why_not) {
  if (mlockall(MCL_CURRENT | MCL_FUTURE) != 0) {
    why_not = std::strerror(errno);
    return false;
  }
  if (!has_room(kAllocatedLater_bytes)) {
    munlockall();
    why_not = "the limit of locked memory is too low";
    return false;
  }
  touch_stack();
  return true;
}

void use_normal_scheduler() {
  const sched_param none{};
  pthread_setschedparam(pthread_self(), SCHED_OTHER, &none);  // needs no permission
}

bool use_fifo(int priority, std::string& why_not) {
  sched_param parameters{};
  parameters.sched_priority = priority;
  const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters);
  if (error != 0) why_not = std::strerror(error);
  return error == 0;
}

}  // namespace sidestep
