#include <drake/lcmt_iiwa_command.hpp>
#include <drake/lcmt_iiwa_status.hpp>

#include "tests/support/check.h"

namespace {

void the_layouts_of_the_iiwa_equal_those_of_drake(void**) {
  assert_true(static_cast<uint64_t>(drake::lcmt_iiwa_command::getHash()) == 0xddc7c7738c815334);
  assert_true(static_cast<uint64_t>(drake::lcmt_iiwa_status::getHash()) == 0xf16fb804284abca3);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {cmocka_unit_test(the_layouts_of_the_iiwa_equal_those_of_drake)};
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
