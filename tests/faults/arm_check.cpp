#include <algorithm>
#include <sstream>

#include "tests/support/check.h"
#include "tests/support/process.h"
#include "tests/support/scratch.h"

using namespace sidestep;
using test::Process;
using test::replaced;
using test::scratch_file;

namespace {

constexpr double kLimit_s = 20.0;
const char kForearm[] = R"(<cylinder radius="0.05" length="0.2765"/>)";

struct Ended {
  int code;
  std::string output;
};

Ended arm_check(const std::string& urdf) {
  Process process({"build/arm-check", urdf, "--base", "base_link", "--tip", "tool"});
  const int code = process.wait(kLimit_s);
  return {code, process.output()};
}

bool has(const Ended& ended, const std::string& words) {
  return ended.output.find(words) != std::string::npos;
}

void an_arm_without_oddities_ends_with_code_0(void**) {
  const Ended ended = arm_check("urdf/lwa3.urdf");
  check(ended.code == 0 && has(ended, "7 joints") && !has(ended, "odd:"), "%d: %s", ended.code, ended.output.c_str());
}

void a_mesh_is_enclosed_and_its_excess_reported(void**) {
  // An edge of 0.6 m between two of 0.01 m, given in millimetres.
  scratch_file("rod.obj", "v 0 0 0\nv 600 0 0\nv 0 10 0\nv 0 0 10\nf 1 2 3\nf 1 2 4\nf 2 3 4\nf 1 3 4\n");
  const std::string urdf =
      replaced(test::text_of("urdf/lwa3.urdf"), kForearm, R"(<mesh filename="rod.obj" scale="0.001 0.001 0.001"/>)");
  const Ended ended = arm_check(scratch_file("rod.urdf", urdf));
  const size_t line = ended.output.find("  forearm_link  ");
  check(line != std::string::npos, "%s", ended.output.c_str());
  double body = 0, radius_m = 0, length_m = 0, excess_m = 0;
  check(std::sscanf(ended.output.c_str() + line, " forearm_link %lf %lf %lf %lf", &body, &radius_m, &length_m,
                    &excess_m) == 4,
        "%s", ended.output.c_str());
  check(radius_m < 0.01 && length_m > 0.58 && excess_m < 0.001, "%s", ended.output.c_str());
}

void oddities_are_reported_with_code_1(void**) {
  const std::string urdf =
      replaced(test::text_of("urdf/lwa3.urdf"), R"(lower="-6.25" upper="6.25")", R"(lower="0.1" upper="0.15")");
  const Ended ended = arm_check(scratch_file("odd.urdf", urdf));
  check(ended.code == 1 && has(ended, "odd: joint 'joint_1' can only move 0.05 rad") &&
            has(ended, "odd: joint 'joint_1' cannot be at 0"),
        "%d: %s", ended.code, ended.output.c_str());
}

void an_arm_that_the_controller_refuses_ends_with_code_2(void**) {
  const std::string good = test::text_of("urdf/lwa3.urdf");
  const std::string mesh = replaced(good, kForearm, R"(<mesh filename="package://unknown/none.stl"/>)");
  const Ended missing = arm_check(scratch_file("missing.urdf", mesh));
  check(missing.code == 2 && has(missing, "link 'forearm_link': mesh 'package://unknown/none.stl'"), "%d: %s",
        missing.code, missing.output.c_str());
  assert_int_equal(arm_check("no/such.urdf").code, 2);
}

void invalid_joint_positions_are_refused_with_their_line(void**) {
  const auto poses = [](const std::string& lines) {
    Process process(
        {"/bin/sh", "-c", "printf '" + lines + "' | build/arm-check urdf/lwa3.urdf --base base_link --tip tool --fk"});
    const int code = process.wait(kLimit_s);
    return Ended{code, process.output()};
  };
  const Ended good = poses("0 0 0 0 0 0 0\\n\\n0.1 0 0 0 0 0 0\\n");
  check(good.code == 0 && std::count(good.output.begin(), good.output.end(), '\n') == 2, "%s", good.output.c_str());
  for (const char* bad : {"1 2 3", "0 0 0 0 0 0 nan", "0 0 0 0 0 0 0 0", "0 0 0 x 0 0 0"}) {
    const Ended ended = poses(std::string("0 0 0 0 0 0 0\\n") + bad + "\\n");
    check(ended.code == 2 && has(ended, "line 2: not 7 joint positions"), "%s: %d, %s", bad, ended.code,
          ended.output.c_str());
  }
}

void the_links_nearest_to_their_clearance_are_found_for_every_configuration(void**) {
  Process process({"/bin/sh", "-c",
                   "printf '0 0 0 0 0 0 0\\n0 0 0 3 0 0 0\\n' | build/arm-check urdf/lwa3.urdf --base base_link "
                   "--tip tool --self"});
  const int code = process.wait(kLimit_s);
  std::istringstream lines(process.output());
  double room_m = 0.0, distance_m = 0.0, folded_m = 0.0;
  std::string one, other;
  assert_true(static_cast<bool>(lines >> room_m >> distance_m >> one >> other >> folded_m));
  assert_int_equal(code, 0);
  check(room_m > 0.0 && folded_m < 0.0, "stretched %g, folded %g", room_m, folded_m);
  check_near(distance_m - room_m, 0.02, 1e-6);
  assert_string_not_equal(one.c_str(), other.c_str());
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test_teardown(an_arm_without_oddities_ends_with_code_0, test::kill_processes),
      cmocka_unit_test_teardown(a_mesh_is_enclosed_and_its_excess_reported, test::kill_processes),
      cmocka_unit_test_teardown(oddities_are_reported_with_code_1, test::kill_processes),
      cmocka_unit_test_teardown(invalid_joint_positions_are_refused_with_their_line, test::kill_processes),
      cmocka_unit_test_teardown(the_links_nearest_to_their_clearance_are_found_for_every_configuration,
                                test::kill_processes),
      cmocka_unit_test_teardown(an_arm_that_the_controller_refuses_ends_with_code_2, test::kill_processes),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
