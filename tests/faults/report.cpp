// The page that host/tools/report.py makes of a log.

#include "tests/support/python_check.h"

namespace {

void passes(const char* name) {
  sidestep::test::require_python_check("report_check.py", name);
}

void a_log_becomes_one_page_that_needs_no_network(void**) {
  passes("log_becomes_page");
}
void a_log_of_hostile_messages_becomes_a_page(void**) {
  passes("hostile_log");
}
void modes_and_faults_are_on_the_page_by_name(void**) {
  passes("faults_on_page");
}
void no_line_crosses_a_time_from_which_nothing_is_logged(void**) {
  passes("gaps");
}
void what_is_possible_while_obstacles_are_silent_is_no_contact(void**) {
  passes("silent_obstacles");
}
void limits_on_the_page_are_those_of_the_configuration(void**) {
  passes("limits");
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test_teardown(a_log_becomes_one_page_that_needs_no_network, sidestep::test::kill_processes),
      cmocka_unit_test_teardown(a_log_of_hostile_messages_becomes_a_page, sidestep::test::kill_processes),
      cmocka_unit_test_teardown(modes_and_faults_are_on_the_page_by_name, sidestep::test::kill_processes),
      cmocka_unit_test_teardown(no_line_crosses_a_time_from_which_nothing_is_logged, sidestep::test::kill_processes),
      cmocka_unit_test_teardown(what_is_possible_while_obstacles_are_silent_is_no_contact,
                                sidestep::test::kill_processes),
      cmocka_unit_test_teardown(limits_on_the_page_are_those_of_the_configuration, sidestep::test::kill_processes),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
