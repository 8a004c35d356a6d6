#include "firmware/base/histogram.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/support/allocation_count.h"
#include "tests/support/check.h"
#include "tests/support/random.h"

using namespace sidestep;

namespace {

void the_quantiles_of_an_empty_histogram_are_0(void**) {
  const Histogram histogram;
  assert_int_equal(histogram.count(), 0);
  check_near(histogram.quantile_s(0.5), 0.0, 0.0);
  check_near(histogram.worst_s(), 0.0, 0.0);
}

void one_duration_is_every_quantile(void**) {
  Histogram histogram;
  histogram.add(42e-6);
  for (const double share : {0.0, 0.5, 0.99, 1.0}) check_near(histogram.quantile_s(share), 42e-6, 0.0);
}

void quantiles_are_never_too_low_and_at_most_a_bin_too_high(void**) {
  test::Random random(3);
  Histogram histogram;
  std::vector<double> durations;
  for (int i = 0; i < 20000; ++i) {
    durations.push_back(std::exp(random.uniform(std::log(2e-7), 0.0)));
    histogram.add(durations.back());
  }
  std::sort(durations.begin(), durations.end());
  for (const double share : {0.001, 0.1, 0.5, 0.9, 0.99, 0.999, 1.0}) {
    const double exact_s = durations[static_cast<size_t>(std::ceil(share * 20000)) - 1];
    const double ratio = histogram.quantile_s(share) / exact_s;
    check(ratio >= 1.0 && ratio < 1.0443, "%g: %g times the exact one", share, ratio);
  }
  check_near(histogram.worst_s(), durations.back(), 0.0);
  assert_int_equal(histogram.count(), 20000);
}

void durations_outside_the_bins_and_nan_are_counted(void**) {
  Histogram histogram;
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double odd_s : {0.0, -1.0, 1e-12, std::nan(""), -infinity, 100.0, infinity}) histogram.add(odd_s);
  assert_int_equal(histogram.count(), 7);
  check(histogram.quantile_s(0.5) < 2e-7, "%g", histogram.quantile_s(0.5));
  check_near(histogram.quantile_s(1.0), infinity, 0.0);
}

void adding_allocates_nothing(void**) {
  Histogram histogram;
  const int64_t before = test::allocation_count();
  for (int i = 0; i < 1000; ++i) histogram.add(1e-6 * i);
  assert_int_equal(test::allocation_count() - before, 0);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(the_quantiles_of_an_empty_histogram_are_0),
      cmocka_unit_test(one_duration_is_every_quantile),
      cmocka_unit_test(quantiles_are_never_too_low_and_at_most_a_bin_too_high),
      cmocka_unit_test(durations_outside_the_bins_and_nan_are_counted),
      cmocka_unit_test(adding_allocates_nothing),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
