// The page that host/tools/report.py makes of a log.

#include "tests/support/check.h"
#include "tests/support/process.h"

using sidestep::test::Process;

namespace {

void passes(const char* name) {
  Process python({"build/venv/bin/python", "tests/support/report_check.py", name});
  const int code = python.wait(60.0);
  check(code == 0, "%s: %s", name, python.output().c_str());
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
void limits_on_the_page_are_those_of_the_configuration(void**) {
  passes("limits");
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test_teardown(a_log_becomes_one_page_that_needs_no_network, sidestep::test::kill_processes),
      cmocka_unit_test_teardown(a_log_of_hostile_messages_becomes_a_page, sidestep::test::kill_processes),
      cmocka_unit_test_teardown(modes_and_faults_are_on_the_page_by_name, sidestep::test::kill_processes),
      cmocka_unit_test_teardown(limits_on_the_page_are_those_of_the_configuration, sidestep::test::kill_processes),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
