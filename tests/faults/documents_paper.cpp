#include "tests/support/documents.h"

namespace {

void the_documents_have_the_results_of_the_papers_scenes(void**) {
  sidestep::test::check_documents({"paper-a", "paper-b", "paper-c"});
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test_teardown(the_documents_have_the_results_of_the_papers_scenes, sidestep::test::kill_processes),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
