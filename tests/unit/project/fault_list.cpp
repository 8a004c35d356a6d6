#include <regex>

#include "tests/support/check.h"
#include "tests/support/scratch.h"

using sidestep::test::text_of;

namespace {

/// Whether a source file defines a test function and runs it.
bool runs(const std::string& code, const std::string& test) {
  return std::regex_search(code, std::regex("void " + test + "\\(void\\*\\*\\)")) &&
         std::regex_search(code, std::regex("cmocka_unit_test\\w*\\(" + test + "\\b"));
}

void every_test_in_the_table_of_faults_is_run(void**) {
  const std::string list = text_of("tests/faults/README.md");
  const std::regex name("`(unit|loop|faults)/([\\w/]+): (\\w+)` \\|\n");
  int named = 0;
  for (std::sregex_iterator at(list.begin(), list.end(), name), end; at != end; ++at, ++named) {
    const std::string file = "tests/" + at->str(1) + "/" + at->str(2) + ".cpp";
    check(runs(text_of(file), at->str(3)), "%s does not run %s", file.c_str(), at->str(3).c_str());
  }
  const std::regex row("\n\\|[^-\n][^\n]*\\|[^\n]*\\|(?=\n)");
  const auto rows = std::distance(std::sregex_iterator(list.begin(), list.end(), row), std::sregex_iterator());
  assert_int_equal(named, rows - 1);  // every row but the heading names its test
}

void a_test_that_is_not_run_is_detected(void**) {
  const std::string code = "void good(void**) {\n}\nvoid lost(void**) {\n}\n cmocka_unit_test(good),";
  assert_true(runs(code, "good"));
  assert_false(runs(code, "lost"));
  assert_false(runs(code, "goo"));
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(every_test_in_the_table_of_faults_is_run),
      cmocka_unit_test(a_test_that_is_not_run_is_detected),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
