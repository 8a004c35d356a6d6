#include "firmware/model/reach.h"

#include "firmware/model/kinematics.h"
#include "tests/support/check.h"
#include "tests/support/lwa3.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::lwa3;
using test::Random;

namespace {

void no_configuration_is_beyond_reach(void**) {
  Random random(1);
  for (int trial = 0; trial < 10'000; ++trial)
    assert_false(is_beyond_reach(lwa3(), forward_kinematics(lwa3(), random.configuration(lwa3())).tool_position));
}

void the_stretched_arm_is_the_bound(void**) {
  const Vector3 tool_m = forward_kinematics(lwa3(), JointVector::Zero(7)).tool_position;
  const Vector3 shoulder_m = lwa3().joint_placement[1].translation();
  assert_false(is_beyond_reach(lwa3(), shoulder_m + 0.9999 * (tool_m - shoulder_m)));
  assert_true(is_beyond_reach(lwa3(), shoulder_m + 1.0001 * (tool_m - shoulder_m)));
  assert_true(is_beyond_reach(lwa3(), Vector3(0, -900, 0)));
}

void a_lift_adds_its_travel(void**) {
  const Arm lift = load_arm("tests/data/lift_arm.urdf", "mast", "tool");
  Random random(2);
  for (int trial = 0; trial < 10'000; ++trial)
    assert_false(is_beyond_reach(lift, forward_kinematics(lift, random.configuration(lift)).tool_position));
  assert_true(is_beyond_reach(lift, Vector3(0, 0, 900)));
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(no_configuration_is_beyond_reach),
      cmocka_unit_test(the_stretched_arm_is_the_bound),
      cmocka_unit_test(a_lift_adds_its_travel),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
