#include "firmware/io/config/yaml_section.h"

#include <limits>

#include "tests/support/check.h"
#include "tests/support/scratch.h"

using namespace sidestep;
using test::message_of;
using test::one_line_with;

namespace {

constexpr NumberRange kUnitRange{0.0, 1.0};
const double kInfinity = std::numeric_limits<double>::infinity();

YamlSection section_of(const std::string& yaml) {
  return YamlSection::of_file(test::scratch_file("section.yaml", yaml));
}

void an_optional_key_that_is_absent_or_null_leaves_the_value(void**) {
  for (const char* yaml : {"", "key: ~\n", "key:\n"}) {
    YamlSection section = section_of(yaml);
    double number = 0.25;
    int whole = 7;
    bool flag = true;
    std::string text = "before";
    std::vector<std::string> texts = {"before"};
    Vector3 vector(1, 2, 3);
    JointVector joints = JointVector::Constant(6, 4.0);
    section.number("key", number, kUnitRange);
    section.whole("key", whole, kUnitRange);
    section.flag("key", flag);
    section.text("key", text);
    section.texts("key", texts);
    section.vector("key", vector, kUnitRange);
    section.per_joint("key", 6, joints, kUnitRange);
    assert_true(number == 0.25 && whole == 7 && flag && text == "before" && texts.size() == 1);
    check_near(vector, Vector3(1, 2, 3), 0);
    check_near(joints, JointVector::Constant(6, 4.0), 0);
    assert_true(section.sections("key").empty());
    section.section("key").finish();
    section.finish();
  }
}

void a_required_key_that_is_absent_or_null_is_refused(void**) {
  for (const char* yaml : {"", "key: ~\n"}) {
    YamlSection section = section_of(yaml);
    const std::string errors[] = {
        message_of([&] { section.require("key"); }),
        message_of([&] { section.number("key", kUnitRange); }),
        message_of([&] { section.whole("key", kUnitRange); }),
        message_of([&] { section.text("key"); }),
        message_of([&] { section.choice("key", {"a"}); }),
        message_of([&] { section.vector("key", kUnitRange); }),
        message_of([&] { section.per_joint("key", 6, kUnitRange); }),
        message_of([&] { section.rows("key", {kUnitRange}); }),
    };
    for (const std::string& error : errors)
      check(one_line_with(error, {"section.yaml: key: is missing"}), "'%s'", error.c_str());
  }
}

void a_key_with_null_counts_as_given(void**) {
  assert_true(section_of("key: ~\n").has("key"));
  assert_true(section_of("key: 1\n").has("key"));
  assert_false(section_of("").has("key"));
}

void a_number_is_finite_unless_its_range_is_not(void**) {
  YamlSection section = section_of("a: .inf\nb: -.inf\nc: .nan\n");
  const NumberRange any{-kInfinity, kInfinity};
  assert_true(section.number("a", any) == kInfinity && section.number("b", any) == -kInfinity);
  for (const char* key : {"a", "b"}) {
    const std::string error = message_of([&] { section.number(key, {-1e308, 1e308}); });
    check(one_line_with(error, {"must be a finite number"}), "'%s'", error.c_str());
  }
  assert_true(one_line_with(message_of([&] { section.number("c", any); }), {"c: must be a number"}));
}

void an_unread_key_is_refused(void**) {
  YamlSection section = section_of("known: 1\nlist: [{inner: 1}]\nother: {x: 1}\n");
  section.number("known", kUnitRange);
  assert_true(one_line_with(message_of([&] { section.finish(); }), {"section.yaml: list: unknown key"}));
  std::vector<YamlSection> list = section.sections("list");
  assert_true(one_line_with(message_of([&] { list.front().finish(); }), {"section.yaml: list[0].inner: unknown key"}));
  assert_true(one_line_with(message_of([&] { section.section("other").finish(); }), {"other.x: unknown key"}));
  section.finish();
}

void an_error_names_the_line_of_invalid_yaml(void**) {
  const std::string error = message_of([] { section_of("a: 1\nb: [\n"); });
  check(one_line_with(error, {"section.yaml: line ", "not valid YAML"}), "'%s'", error.c_str());
  const std::string second = message_of([] { section_of("a: 1\n---\nb: 2\n"); });
  check(one_line_with(second, {"section.yaml: line 2: ", "second document"}), "'%s'", second.c_str());
}

void an_error_names_the_line_of_its_key(void**) {
  YamlSection section = section_of("known: 1\nlist:\n  - {inner: 1}\n  - inner: x\n    more: 1\nvalues: [1,\n  2]\n");
  std::vector<YamlSection> list = section.sections("list");
  check(one_line_with(message_of([&] { section.number("known", {2, 3}); }), {"must be from 2 to 3 (line 1)"}), "known");
  check(one_line_with(message_of([&] { list[1].number("inner", kUnitRange); }), {"(line 4)"}), "inner");
  check(one_line_with(message_of([&] { list[1].finish(); }), {"list[1].more: unknown key (line 5)"}), "more");
  check(one_line_with(message_of([&] { list[0].text("absent"); }), {"list[0].absent: is missing (line 3)"}), "absent");
  check(one_line_with(message_of([&] { section.numbers("values", 2, 2, kUnitRange); }), {"values[1]", "(line 6)"}),
        "values");
  YamlSection none = YamlSection::empty();
  const std::string without = message_of([&] { none.text("absent"); });
  check(without.find("line ", 13) == std::string::npos, "'%s'", without.c_str());
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(an_optional_key_that_is_absent_or_null_leaves_the_value),
      cmocka_unit_test(a_required_key_that_is_absent_or_null_is_refused),
      cmocka_unit_test(a_key_with_null_counts_as_given),
      cmocka_unit_test(a_number_is_finite_unless_its_range_is_not),
      cmocka_unit_test(an_unread_key_is_refused),
      cmocka_unit_test(an_error_names_the_line_of_invalid_yaml),
      cmocka_unit_test(an_error_names_the_line_of_its_key),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
