// What the figures say, in host/tools.

#include "tests/support/python_check.h"

namespace {

void passes(const char* name) {
  sidestep::test::require_python_check("figures_check.py", name);
}

void a_tool_that_left_its_target_is_told_apart_from_one_that_never_came(void**) {
  passes("arrivals");
}
void the_decisive_moment_is_drawn(void**) {
  passes("decisive_moments");
}
void names_in_a_picture_cover_neither_each_other_nor_a_mark(void**) {
  passes("placed_labels");
}
void a_scenario_is_explained_in_its_own_whole_sentences(void**) {
  passes("tasks");
}
void an_obstacle_is_called_what_the_scenario_calls_it(void**) {
  passes("names");
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_tool_that_left_its_target_is_told_apart_from_one_that_never_came),
      cmocka_unit_test(the_decisive_moment_is_drawn),
      cmocka_unit_test(names_in_a_picture_cover_neither_each_other_nor_a_mark),
      cmocka_unit_test(a_scenario_is_explained_in_its_own_whole_sentences),
      cmocka_unit_test(an_obstacle_is_called_what_the_scenario_calls_it),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
