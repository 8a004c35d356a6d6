#include <drake/lcmt_iiwa_command.hpp>
#include <drake/lcmt_iiwa_status.hpp>
#include <drake/lcmt_viewer_draw.hpp>
#include <drake/lcmt_viewer_load_robot.hpp>

#include "tests/support/check.h"

namespace {

void the_layouts_of_the_viewer_equal_those_of_drake(void**) {
  assert_true(static_cast<uint64_t>(drake::lcmt_viewer_load_robot::getHash()) == 0x8987209b10aa2d39);
  assert_true(static_cast<uint64_t>(drake::lcmt_viewer_draw::getHash()) == 0x414f0bfe5b2f4244);
}

void the_layouts_of_the_iiwa_equal_those_of_drake(void**) {
  assert_true(static_cast<uint64_t>(drake::lcmt_iiwa_command::getHash()) == 0xddc7c7738c815334);
  assert_true(static_cast<uint64_t>(drake::lcmt_iiwa_status::getHash()) == 0xf16fb804284abca3);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {cmocka_unit_test(the_layouts_of_the_viewer_equal_those_of_drake),
                              cmocka_unit_test(the_layouts_of_the_iiwa_equal_those_of_drake)};
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
