#include "firmware/base/load_limit.h"

#include <vector>

#include "tests/support/check.h"
#include "tests/support/random.h"

using namespace sidestep;

namespace {

constexpr double kShare = 0.25, kBurst_s = 0.03;

void work_within_the_share_is_not_delayed(void**) {
  LoadLimit limit(kShare, kBurst_s, 5.0);
  for (int i = 1; i < 1000; ++i) {
    const double now_s = 5.0 + 0.01 * i;
    check_near(limit.next_start_s(now_s, 0.99 * kShare * 0.01 * i), now_s, 0.0);
  }
}

void a_burst_may_follow_a_rest_and_no_more(void**) {
  LoadLimit limit(kShare, kBurst_s, 0.0);
  check_near(limit.next_start_s(100.0, 0.0), 100.0, 0.0);
  check_near(limit.next_start_s(100.0, kBurst_s), 100.0, 1e-12);
  check_near(limit.next_start_s(100.0, kBurst_s + 0.01), 100.0 + 0.01 / kShare, 1e-12);
}

void any_span_of_time_has_the_share_and_at_most_the_burst_and_one_piece_more(void**) {
  constexpr double kPiece_s = 0.02;
  test::Random random(7);
  LoadLimit limit(kShare, kBurst_s, 0.0);
  std::vector<double> starts_s, used_s;
  double now_s = 0.0, used = 0.0;
  for (int i = 0; i < 2000; ++i) {
    starts_s.push_back(now_s);
    used_s.push_back(used);
    const double work_s = random.uniform(0.0, kPiece_s);
    used += work_s;
    now_s = limit.next_start_s(now_s + work_s, used);
    if (i % 100 == 0) now_s += random.uniform(0.0, 1.0);
  }
  for (size_t from = 0; from < starts_s.size(); ++from) {
    for (size_t to = from; to < starts_s.size(); ++to) {
      const double allowed_s = kShare * (starts_s[to] - starts_s[from]) + kBurst_s + kPiece_s;
      assert_true(used_s[to] - used_s[from] <= allowed_s + 1e-9);
    }
  }
}

void a_thread_that_always_has_work_gets_its_share(void**) {
  LoadLimit limit(kShare, kBurst_s, 0.0);
  double now_s = 0.0, used_s = 0.0;
  while (now_s < 100.0) now_s = limit.next_start_s(now_s + 0.005, used_s += 0.005);
  check_near(used_s, kShare * now_s, kBurst_s + 0.005);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(work_within_the_share_is_not_delayed),
      cmocka_unit_test(a_burst_may_follow_a_rest_and_no_more),
      cmocka_unit_test(any_span_of_time_has_the_share_and_at_most_the_burst_and_one_piece_more),
      cmocka_unit_test(a_thread_that_always_has_work_gets_its_share),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
