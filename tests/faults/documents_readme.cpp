// What README.md shows.

#include <algorithm>

#include "tests/support/python_check.h"
#include "tests/support/scratch.h"

namespace {

void passes(const char* name) {
  sidestep::test::require_python_check("readme_check.py", name, 110.0);
}

void a_moving_picture_says_what_the_run_did(void**) {
  passes("moving_picture");
}
void the_python_example_sends_target_and_obstacle(void**) {
  passes("example");
}

void the_readme_is_short(void**) {
  const std::string text = sidestep::test::text_of("README.md");
  const auto lines = std::count(text.begin(), text.end(), '\n');
  check(lines > 0 && lines <= 130, "README.md has %d lines", static_cast<int>(lines));
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(the_readme_is_short),
      cmocka_unit_test_teardown(a_moving_picture_says_what_the_run_did, sidestep::test::kill_processes),
      cmocka_unit_test_teardown(the_python_example_sends_target_and_obstacle, sidestep::test::kill_processes),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
