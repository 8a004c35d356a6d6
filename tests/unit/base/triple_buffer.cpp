#include "firmware/base/triple_buffer.h"

#include <chrono>
#include <thread>

#include "tests/support/check.h"

using namespace sidestep;

namespace {

/// Large enough that writing it takes a while; whole when every element says the same.
struct Page {
  std::array<int64_t, 512> words{};
  bool whole() const {
    for (const int64_t word : words)
      if (word != words[0]) return false;
    return true;
  }
};

void a_new_mailbox_holds_the_default_value(void**) {
  TripleBuffer<int> box;
  assert_int_equal(box.latest(), 0);
}

void the_newest_value_is_read_again_and_again(void**) {
  TripleBuffer<int> box;
  for (int value = 1; value < 100; ++value) {
    box.draft() = value;
    if (value > 1) assert_int_equal(box.latest(), value - 1);  // a draft is not yet posted
    box.post();
    assert_int_equal(box.latest(), value);
    assert_int_equal(box.latest(), value);
  }
}

void values_never_read_are_overwritten_by_newer_ones(void**) {
  TripleBuffer<int> box;
  for (int round = 0; round < 50; ++round) {
    for (int value = 0; value <= round; ++value) {
      box.draft() = 100 * round + value;
      box.post();
    }
    assert_int_equal(box.latest(), 100 * round + round);
  }
}

void what_was_read_stays_unchanged_while_others_are_posted(void**) {
  TripleBuffer<int> box;
  box.draft() = 7;
  box.post();
  const int& read = box.latest();
  for (int value = 8; value < 20; ++value) {
    box.draft() = value;
    box.post();
    assert_int_equal(read, 7);
  }
  assert_int_equal(box.latest(), 19);
}

void two_threads_see_whole_values_in_order(void**) {
  static TripleBuffer<Page> box;
  std::atomic<bool> done{false};
  std::thread writer([&] {
    for (int64_t value = 1; !done; ++value) {
      box.draft().words.fill(value);
      box.post();
    }
  });
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(2);
  int64_t last = 0, torn = 0, back = 0, seen = 0, changed = 0;
  while (seen < 200000 && std::chrono::steady_clock::now() < end) {
    const Page& page = box.latest();
    torn += !page.whole();
    const int64_t value = page.words[0];
    back += value < last;
    seen += value != last;
    last = value;
    changed += !page.whole() || page.words[0] != value;  // still, while the writer goes on
  }
  done = true;
  writer.join();
  check(torn == 0 && back == 0 && changed == 0, "%ld torn, %ld went back, %ld changed while read", torn, back, changed);
  check(seen > 20, "only %ld values were seen: the threads did not run side by side", seen);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_new_mailbox_holds_the_default_value),
      cmocka_unit_test(the_newest_value_is_read_again_and_again),
      cmocka_unit_test(values_never_read_are_overwritten_by_newer_ones),
      cmocka_unit_test(what_was_read_stays_unchanged_while_others_are_posted),
      cmocka_unit_test(two_threads_see_whole_values_in_order),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
