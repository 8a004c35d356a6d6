#include "firmware/base/command_line.h"

#include <iostream>
#include <sstream>

#include "tests/support/check.h"

using namespace sidestep;

namespace {

struct Values {
  std::string file = "a.yaml", law = "sidestep";
  double rate_hz = 100.0;
  int jobs = 2;
  uint64_t count = 500;
  bool quiet = false;
  std::vector<std::string> rules, folders, merge;
};

struct Outcome {
  std::optional<int> exit_code;
  std::string out, error;
};

/// Collects what a stream receives while this object lives.
class Capture {
 public:
  explicit Capture(std::ostream& stream) : stream_(stream), before_(stream.rdbuf(text_.rdbuf())) {}
  ~Capture() { stream_.rdbuf(before_); }
  std::string text() const { return text_.str(); }

 private:
  std::ostringstream text_;
  std::ostream& stream_;
  std::streambuf* before_;
};

Outcome parse(Values& values, std::vector<std::string> arguments) {
  CommandLine line("A program for tests.");
  line.add_option("FILE", values.file, "a file").required();
  line.add_option("--law", values.law, "the law").show_default().one_of({"sidestep", "paper"});
  line.add_option("--rate", values.rate_hz, "cycles a second").type_name("HZ").range(10.0, 2000.0).not_nan();
  line.add_option("--jobs", values.jobs, "threads").range(1, 8);
  line.add_option("--count", values.count, "scenes").range(1, 1000);
  line.add_option("--rule", values.rules, "rules");
  line.add_option("--folder", values.folders, "folders").one_value_at_a_time();
  line.add_flag("--quiet", values.quiet, "no progress");
  line.add_subcommand("merge", "merges files").add_option("files", values.merge, "files").required();
  line.footer("Exit codes: 0 or 2.");
  arguments.insert(arguments.begin(), "program");
  std::vector<char*> pointers;
  pointers.reserve(arguments.size());
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  const Capture out(std::cout), error(std::cerr);
  const std::optional<int> exit_code = line.parse(static_cast<int>(pointers.size()), pointers.data());
  return {exit_code, out.text(), error.text()};
}

void values_reach_their_variables(void**) {
  Values values;
  const Outcome outcome = parse(values, {"b.yaml", "--law", "paper", "--rate", "250", "--jobs", "8", "--count", "1000",
                                         "--quiet", "--rule", "one", "two"});
  check(!outcome.exit_code, "%s", outcome.error.c_str());
  assert_string_equal(values.file.c_str(), "b.yaml");
  assert_string_equal(values.law.c_str(), "paper");
  check_near(values.rate_hz, 250.0, 0.0);
  assert_int_equal(values.jobs, 8);
  assert_int_equal(values.count, 1000);
  assert_true(values.quiet);
  check(values.rules == std::vector<std::string>({"one", "two"}), "%zu rules", values.rules.size());
}

void an_absent_option_leaves_its_variable_unchanged(void**) {
  Values values;
  assert_false(parse(values, {"b.yaml"}).exit_code.has_value());
  assert_string_equal(values.law.c_str(), "sidestep");
  check_near(values.rate_hz, 100.0, 0.0);
  assert_false(values.quiet);
}

void an_option_with_one_value_at_a_time_leaves_the_next_argument_to_others(void**) {
  Values values;
  assert_false(parse(values, {"--folder", "one", "--folder", "two", "b.yaml"}).exit_code.has_value());
  assert_string_equal(values.file.c_str(), "b.yaml");
  check(values.folders == std::vector<std::string>({"one", "two"}), "%zu folders", values.folders.size());
}

void options_of_the_program_may_follow_a_subcommand(void**) {
  Values values;
  const Outcome outcome = parse(values, {"b.yaml", "merge", "one.csv", "two.csv", "--quiet"});
  check(!outcome.exit_code, "%s", outcome.error.c_str());
  check(values.merge == std::vector<std::string>({"one.csv", "two.csv"}), "%zu files", values.merge.size());
  assert_true(values.quiet);
}

void help_is_printed_with_exit_code_0(void**) {
  Values values;
  const Outcome outcome = parse(values, {"--help"});
  assert_int_equal(outcome.exit_code.value_or(-1), 0);
  for (const char* part : {"A program for tests.", "FILE", "--law", "{sidestep,paper}", "=sidestep", "HZ",
                           "merges files", "Exit codes: 0 or 2."})
    check(outcome.out.find(part) != std::string::npos, "no '%s' in '%s'", part, outcome.out.c_str());
  check(outcome.error.empty(), "%s", outcome.error.c_str());
}

void wrong_arguments_are_reported_with_exit_code_2(void**) {
  const struct {
    std::vector<std::string> arguments;
    const char* part;
  } cases[] = {
      {{}, "FILE is required"},
      {{"b.yaml", "--none"}, "--none"},
      {{"b.yaml", "--law", "chaos"}, "--law: chaos not in {sidestep,paper}"},
      {{"b.yaml", "--rate", "9"}, "--rate: Value 9 not in range"},
      {{"b.yaml", "--rate", "nan"}, "--rate: is not a number"},
      {{"b.yaml", "--rate", "fast"}, "--rate"},
      {{"b.yaml", "--jobs", "9"}, "--jobs: Value 9 not in range"},
      {{"b.yaml", "--count", "-1"}, "--count"},
      {{"b.yaml", "merge"}, "files is required"},
  };
  for (const auto& one : cases) {
    Values values;
    const Outcome outcome = parse(values, one.arguments);
    check(outcome.exit_code == 2, "%s: code %d", one.part, outcome.exit_code.value_or(-1));
    check(outcome.out.empty() && outcome.error.find(one.part) != std::string::npos, "'%s' not in '%s'", one.part,
          outcome.error.c_str());
  }
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(values_reach_their_variables),
      cmocka_unit_test(an_absent_option_leaves_its_variable_unchanged),
      cmocka_unit_test(an_option_with_one_value_at_a_time_leaves_the_next_argument_to_others),
      cmocka_unit_test(options_of_the_program_may_follow_a_subcommand),
      cmocka_unit_test(help_is_printed_with_exit_code_0),
      cmocka_unit_test(wrong_arguments_are_reported_with_exit_code_2),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
