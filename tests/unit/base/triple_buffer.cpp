#include "firmware/base/triple_buffer.h"

#include <chrono>
#include <thread>

#include "tests/support/check.h"

using namespace sidestep;

namespace {

/// Large enough that writing it takes a while. Whole if all elements are equal.
struct Page {
  std::array<int64_t, 512> words{};
  bool whole() const {
    for (const int64_t word : words)
      if (word != words[0]) return false;
    return true;
  }
};

void a_new_buffer_holds_the_default_value(void**) {
  TripleBuffer<int> buffer;
  assert_int_equal(buffer.latest(), 0);
}

void the_newest_value_can_be_read_repeatedly(void**) {
  TripleBuffer<int> buffer;
  for (int value = 1; value < 100; ++value) {
    buffer.draft() = value;
    if (value > 1) assert_int_equal(buffer.latest(), value - 1);  // a draft is not yet posted
    buffer.publish();
    assert_int_equal(buffer.latest(), value);
    assert_int_equal(buffer.latest(), value);
  }
}

void values_never_read_are_overwritten_by_newer_ones(void**) {
  TripleBuffer<int> buffer;
  for (int round = 0; round < 50; ++round) {
    for (int value = 0; value <= round; ++value) {
      buffer.draft() = 100 * round + value;
      buffer.publish();
    }
    assert_int_equal(buffer.latest(), 100 * round + round);
  }
}

void a_value_that_was_read_stays_unchanged_while_others_are_posted(void**) {
  TripleBuffer<int> buffer;
  buffer.draft() = 7;
  buffer.publish();
  const int& read = buffer.latest();
  for (int value = 8; value < 20; ++value) {
    buffer.draft() = value;
    buffer.publish();
    assert_int_equal(read, 7);
  }
  assert_int_equal(buffer.latest(), 19);
}

void two_threads_see_whole_values_in_order(void**) {
  static TripleBuffer<Page> buffer;
  std::atomic<bool> done{false};
  std::thread writer([&] {
    for (int64_t value = 1; !done; ++value) {
      buffer.draft().words.fill(value);
      buffer.publish();
    }
  });
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(2);
  int64_t last = 0, torn = 0, back = 0, seen = 0, changed = 0;
  while (seen < 200000 && std::chrono::steady_clock::now() < end) {
    const Page& page = buffer.latest();
    torn += !page.whole();
    const int64_t value = page.words[0];
    back += value < last;
    seen += value != last;
    last = value;
    changed += !page.whole() || page.words[0] != value;  // while the writer continues
  }
  done = true;
  writer.join();
  check(torn == 0 && back == 0 && changed == 0, "%ld torn, %ld went back, %ld changed while read", torn, back, changed);
  check(seen > 20, "only %ld values were seen: the threads did not run at the same time", seen);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_new_buffer_holds_the_default_value),
      cmocka_unit_test(the_newest_value_can_be_read_repeatedly),
      cmocka_unit_test(values_never_read_are_overwritten_by_newer_ones),
      cmocka_unit_test(a_value_that_was_read_stays_unchanged_while_others_are_posted),
      cmocka_unit_test(two_threads_see_whole_values_in_order),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
