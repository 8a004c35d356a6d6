#pragma once

#include <array>
#include <atomic>

namespace sidestep {

/// Passes the latest value from one writing thread to one reading thread; neither thread ever waits. There are three
/// slots: the writer fills one, the reader reads one, and the third holds the newest complete value until the writer or
/// the reader exchanges its slot for it. Values that are not read in time are overwritten.
template <typename Value>
class TripleBuffer {
 public:
  /// Writer: the slot to fill. It contains some earlier value.
  Value& draft() { return slots_[draft_]; }

  /// Writer: makes the draft the newest value.
  void publish() {
    draft_ = middle_.exchange(static_cast<unsigned>(draft_) | kNew, std::memory_order_acq_rel) & kIndex;
  }

  /// Reader: the newest published value; a default-constructed one before the first. It stays valid and unchanged
  /// until the next call of latest().
  const Value& latest() {
    if (middle_.load(std::memory_order_relaxed) & kNew)
      reading_ = middle_.exchange(reading_, std::memory_order_acq_rel) & kIndex;
    return slots_[reading_];
  }

 private:
  static constexpr unsigned kIndex = 3;
  static constexpr unsigned kNew = 4;

  std::array<Value, 3> slots_{};
  unsigned draft_ = 0;
  std::atomic<unsigned> middle_{1};
  unsigned reading_ = 2;
};

}  // namespace sidestep
