#include "firmware/io/blackbox/record_ring.h"

#include <chrono>
#include <thread>

#include "tests/support/check.h"
#include "tests/support/random.h"

using namespace sidestep;

namespace {

/// The bytes of a record, all derived from its number.
std::vector<uint8_t> numbered(uint32_t number, size_t size) {
  std::vector<uint8_t> bytes(size);
  for (size_t i = 0; i < size; ++i) bytes[i] = static_cast<uint8_t>(number >> (8 * (i % 4)));
  return bytes;
}

uint32_t number_of(const RecordRing::Copy::Record& record) {
  uint32_t number = 0;
  for (size_t i = 0; i < 4; ++i) number |= static_cast<uint32_t>(record.bytes[i]) << (8 * i);
  return number;
}

bool is_intact(const RecordRing::Copy::Record& record) {
  const std::vector<uint8_t> expected = numbered(number_of(record), record.size);
  return std::equal(expected.begin(), expected.end(), record.bytes);
}

void an_empty_ring_has_no_record(void**) {
  const RecordRing ring(1000);
  RecordRing::Copy copy(ring);
  ring.copy(copy);
  RecordRing::Copy::Record record;
  assert_false(copy.next(record));
}

void records_of_all_sizes_can_be_read_in_order_repeatedly(void**) {
  RecordRing ring(100000);
  for (uint32_t i = 0; i < 40; ++i) {
    const auto bytes = numbered(i, i);
    assert_true(ring.write(static_cast<uint8_t>(200 + i), bytes.data(), bytes.size()));
  }
  RecordRing::Copy copy(ring);
  ring.copy(copy);
  for (int round = 0; round < 2; ++round, copy.rewind()) {
    RecordRing::Copy::Record record;
    for (uint32_t i = 0; i < 40; ++i) {
      assert_true(copy.next(record));
      const auto bytes = numbered(i, i);
      assert_int_equal(record.kind, static_cast<uint8_t>(200 + i));
      assert_true(std::vector<uint8_t>(record.bytes, record.bytes + record.size) == bytes);
    }
    assert_false(copy.next(record));
  }
}

void the_oldest_records_are_overwritten_and_the_newest_fill_the_ring(void**) {
  test::Random random(1);
  RecordRing ring(4096);
  RecordRing::Copy copy(ring);
  for (uint32_t i = 0; i < 3000; ++i) {
    const auto bytes = numbered(i, static_cast<size_t>(random.uniform(4, 600)));
    assert_true(ring.write(1, bytes.data(), bytes.size()));
    ring.copy(copy);
    RecordRing::Copy::Record record;
    size_t stored = 0;
    uint32_t last = 0;
    for (bool first = true; copy.next(record); first = false) {
      check(is_intact(record) && (first || number_of(record) == last + 1), "record %u behind %u", number_of(record),
            last);
      last = number_of(record);
      stored += record.size + 8;
    }
    assert_int_equal(last, i);
    check(i < 100 || stored > 4096 - 2 * 700, "%zu bytes stored", stored);
  }
}

void a_record_larger_than_half_the_ring_is_dropped_and_changes_nothing(void**) {
  RecordRing ring(1024);
  const auto small = numbered(7, 100), large = numbered(8, 600);
  assert_true(ring.write(1, small.data(), small.size()));
  const uint64_t written = ring.written_bytes();
  assert_false(ring.write(1, large.data(), large.size()));
  assert_int_equal(ring.written_bytes(), written);
  RecordRing::Copy copy(ring);
  ring.copy(copy);
  RecordRing::Copy::Record record;
  assert_true(copy.next(record) && number_of(record) == 7 && is_intact(record));
}

void a_copy_taken_while_another_thread_writes_holds_intact_records_in_order(void**) {
  RecordRing ring(1 << 16);
  std::atomic<bool> end{false};
  std::thread writer([&] {
    test::Random random(2);
    for (uint32_t i = 1; !end; ++i) {
      const auto bytes = numbered(i, static_cast<size_t>(random.uniform(4, 2000)));
      ring.write(1, bytes.data(), bytes.size());
    }
  });
  RecordRing::Copy copy(ring);
  int64_t seen = 0, torn = 0, out_of_order = 0, copies = 0;
  const auto stop = std::chrono::steady_clock::now() + std::chrono::seconds(2);
  for (; std::chrono::steady_clock::now() < stop && seen < 200000; ++copies) {
    ring.copy(copy);
    RecordRing::Copy::Record record;
    uint32_t last = 0;
    for (; copy.next(record); ++seen) {
      torn += !is_intact(record);
      out_of_order += last != 0 && number_of(record) != last + 1;
      last = number_of(record);
    }
  }
  end = true;
  writer.join();
  check(torn == 0 && out_of_order == 0, "%ld torn and %ld out of order of %ld", torn, out_of_order, seen);
  check(seen > 100 && copies > 5, "%ld records in %ld copies", seen, copies);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(an_empty_ring_has_no_record),
      cmocka_unit_test(records_of_all_sizes_can_be_read_in_order_repeatedly),
      cmocka_unit_test(the_oldest_records_are_overwritten_and_the_newest_fill_the_ring),
      cmocka_unit_test(a_record_larger_than_half_the_ring_is_dropped_and_changes_nothing),
      cmocka_unit_test(a_copy_taken_while_another_thread_writes_holds_intact_records_in_order),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
