#include "tests/support/documents.h"

namespace {

void the_documents_have_the_results_of_two_arms(void**) {
  sidestep::test::check_documents({"two-arms"});
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test_teardown(the_documents_have_the_results_of_two_arms, sidestep::test::kill_processes),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
