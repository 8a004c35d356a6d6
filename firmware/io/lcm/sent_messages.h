#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace sidestep {

/// The utimes of the last messages that this process sent on a channel, to distinguish them from messages of other
/// senders there. One thread sends, another may query.
class SentMessages {
 public:
  /// To be called before the message is sent.
  void sent(int64_t utime) {
    const unsigned n = count_.load(std::memory_order_relaxed);
    utimes_[n % kKept].store(utime, std::memory_order_relaxed);
    count_.store(n + 1, std::memory_order_release);
  }

  /// Whether one of the last messages had this utime; the search starts at the newest.
  bool has(int64_t utime) const {
    const unsigned newest = count_.load(std::memory_order_acquire);
    for (unsigned i = 1; i <= kKept && i <= newest; ++i)
      if (utimes_[(newest - i) % kKept].load(std::memory_order_relaxed) == utime) return true;
    return false;
  }

 private:
  static constexpr unsigned kKept = 1024;  // what is sent in half a second at the highest rate
  std::array<std::atomic<int64_t>, kKept> utimes_{};
  std::atomic<unsigned> count_{0};
};

}  // namespace sidestep
