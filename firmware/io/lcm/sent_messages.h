#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace sidestep {

/// Tells messages that this process has sent from those of others on the same channel, by their utime. One thread
/// sends, another may ask.
class SentMessages {
 public:
  /// Before the message goes out.
  void sent(int64_t utime) {
    const unsigned n = count_.load(std::memory_order_relaxed);
    utimes_[n % kKept].store(utime, std::memory_order_relaxed);
    count_.store(n + 1, std::memory_order_release);
  }

  /// Whether one of the last messages had this utime; the newest are looked at first.
  bool has(int64_t utime) const {
    const unsigned newest = count_.load(std::memory_order_acquire);
    for (unsigned i = 1; i <= kKept && i <= newest; ++i)
      if (utimes_[(newest - i) % kKept].load(std::memory_order_relaxed) == utime) return true;
    return false;
  }

 private:
  static constexpr unsigned kKept = 1024;  // more than can wait in a queue
  std::array<std::atomic<int64_t>, kKept> utimes_{};
  std::atomic<unsigned> count_{0};
};

}  // namespace sidestep
