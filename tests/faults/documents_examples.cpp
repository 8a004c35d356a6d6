#include "tests/support/documents.h"

namespace {

void the_documents_have_the_results_of_the_example_scenes(void**) {
  sidestep::test::check_documents({"parked-obstacle", "closing-gap", "pillar", "two-people", "moving-shelf", "table",
                                   "iiwa-crossing", "panda-crossing", "shelf-pick", "box", "under-table",
                                   "home-from-under-table", "shelf-with-a-visitor", "fetch", "kitchen"});
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test_teardown(the_documents_have_the_results_of_the_example_scenes, sidestep::test::kill_processes),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
