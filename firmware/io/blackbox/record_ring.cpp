#include "firmware/io/blackbox/record_ring.h"

#include <algorithm>
#include <cstring>

namespace sidestep {
namespace {

constexpr unsigned kKindBits = 8;

uint64_t power_of_two_from(uint64_t least) {
  uint64_t power = 1;
  while (power < least) power *= 2;
  return power;
}

uint64_t length_words(uint64_t title) {
  return 1 + ((title >> kKindBits) + 7) / 8;
}

}  // namespace

RecordRing::RecordRing(size_t bytes)
    : mask_(power_of_two_from(std::max<uint64_t>(bytes / 8, 2)) - 1),
      words_(std::make_unique<std::atomic<uint64_t>[]>(mask_ + 1)) {
  for (uint64_t at = 0; at <= mask_; ++at) put(at, 0);
}

// The tail moves before a word is overwritten, so who reads a new word sees the new tail.
void RecordRing::make_room(uint64_t words) {
  const uint64_t head = head_.load(std::memory_order_relaxed);
  uint64_t tail = tail_.load(std::memory_order_relaxed);
  while (head + words - tail > mask_ + 1) tail += length_words(words_[tail & mask_].load(std::memory_order_relaxed));
  tail_.store(tail, std::memory_order_release);
}

bool RecordRing::write(uint8_t kind, const void* bytes, size_t size) {
  const uint64_t title = static_cast<uint64_t>(size) << kKindBits | kind;
  const uint64_t words = length_words(title);
  if (words > (mask_ + 1) / 2) return false;
  make_room(words);
  const uint64_t head = head_.load(std::memory_order_relaxed);
  put(head, title);
  const auto* from = static_cast<const uint8_t*>(bytes);
  for (uint64_t i = 1; i < words; ++i, from += 8) {
    uint64_t word = 0;
    std::memcpy(&word, from, std::min<size_t>(8, size - 8 * (i - 1)));
    put(head + i, word);
  }
  head_.store(head + words, std::memory_order_release);
  return true;
}

void RecordRing::copy(Copy& copy) const {
  const uint64_t head = head_.load(std::memory_order_acquire);
  const uint64_t from = std::min(head, tail_.load(std::memory_order_acquire));
  for (uint64_t at = from; at < head; ++at) copy.words_[at - from] = words_[at & mask_].load(std::memory_order_acquire);
  const uint64_t intact = std::clamp(tail_.load(std::memory_order_acquire), from, head);
  copy.begin_ = copy.at_ = intact - from;
  copy.end_ = head - from;
}

bool RecordRing::Copy::next(Record& record) {
  if (at_ >= end_) return false;
  const uint64_t title = words_[at_];
  record.kind = static_cast<uint8_t>(title);
  record.bytes = reinterpret_cast<const uint8_t*>(&words_[at_ + 1]);
  record.size = title >> kKindBits;
  at_ += length_words(title);
  return true;
}

}  // namespace sidestep
