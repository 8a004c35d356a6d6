#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

namespace sidestep {

/// A ring of records of any size and kind; new records overwrite the oldest. One thread writes and never waits; any
/// other thread may copy the ring at the same time.
class RecordRing {
 public:
  /// bytes: least capacity. Touches all memory, so that later writes cause no page fault.
  explicit RecordRing(size_t bytes);

  /// Returns false for a record that is larger than half the ring; it is dropped.
  bool write(uint8_t kind, const void* bytes, size_t size);

  /// Bytes written since the start, record headers included; for the writing thread.
  uint64_t written_bytes() const { return 8 * head_.load(std::memory_order_relaxed); }
  size_t capacity_bytes() const { return 8 * (mask_ + 1); }

  /// The content of a ring at one instant.
  class Copy {
   public:
    explicit Copy(const RecordRing& ring) : words_(ring.mask_ + 1) {}

    struct Record {
      uint8_t kind = 0;
      const uint8_t* bytes = nullptr;
      size_t size = 0;
    };
    /// The next record, from the oldest to the newest; false at the end.
    bool next(Record& record);
    void rewind() { at_ = begin_; }

   private:
    friend class RecordRing;
    std::vector<uint64_t> words_;
    size_t begin_ = 0, at_ = 0, end_ = 0;
  };
  /// Skips records that are overwritten during the copy. The copy can be reused.
  void copy(Copy& copy) const;

 private:
  void make_room(uint64_t words);
  void put(uint64_t at, uint64_t word) { words_[at & mask_].store(word, std::memory_order_release); }

  // Positions count the words written since the start. A record is a word with its size and kind, then its bytes.
  uint64_t mask_;
  std::unique_ptr<std::atomic<uint64_t>[]> words_;
  std::atomic<uint64_t> head_{0};  // behind the newest record
  std::atomic<uint64_t> tail_{0};  // the oldest whole record
};

}  // namespace sidestep
