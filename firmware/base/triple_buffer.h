#pragma once

#include <array>
#include <atomic>

namespace sidestep {

/// Passes the newest value from one writing thread to one reading thread; neither ever waits. Of the three slots the
/// writer fills one, the reader uses one, and the third holds the newest complete value and is swapped with either.
template <typename Value>
class TripleBuffer {
 public:
  /// Writer: the slot to fill; its previous content is arbitrary.
  Value& draft() { return slots_[draft_]; }

  /// Writer: makes the draft the newest value.
  void publish() {
    draft_ = middle_.exchange(static_cast<unsigned>(draft_) | kNew, std::memory_order_acq_rel) & kIndex;
  }

  /// Reader: the newest value; valid and unchanged until the next call.
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
