#include "firmware/base/split_mix64.h"

#include "tests/support/check.h"

using sidestep::SplitMix64;

namespace {

/// The first numbers of the reference implementation for the seed 1234567.
void the_reference_sequence_is_reproduced(void**) {
  SplitMix64 random(1234567);
  for (const uint64_t bits : {6457827717110365317u, 3203168211198807973u, 9817491932198370423u}) {
    const double expected = static_cast<double>(bits >> 11) / 9007199254740992.0;
    check_near(random.uniform(0.0, 1.0), expected, 0.0);
  }
}

void numbers_are_uniform_within_their_bounds(void**) {
  SplitMix64 random(1);
  const int draws = 100000;
  double sum = 0.0;
  for (int i = 0; i < draws; ++i) {
    const double value = random.uniform(-2.0, 3.0);
    check(value >= -2.0 && value < 3.0, "%g", value);
    sum += value;
  }
  check_near(sum / draws, 0.5, 0.02);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(the_reference_sequence_is_reproduced),
      cmocka_unit_test(numbers_are_uniform_within_their_bounds),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
