#include "firmware/control/posture_law.h"

#include "tests/support/check.h"
#include "tests/support/lwa3.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::lwa3;
using test::Random;

namespace {

NominalCommand toward(const JointVector& goal_rad, const JointVector& q_rad, const SidestepGains& gains) {
  const LinkPoses poses = forward_kinematics(lwa3(), q_rad);
  const TaskJacobian jacobian = tool_jacobian(poses, 3);
  Target target;
  target.posture_rad = goal_rad;
  const JointVector rest = JointVector::Zero(7);
  const ObstacleView obstacles{};
  const Clearance clearance{};
  return posture_law(gains, {lwa3(), poses, jacobian, q_rad, rest, target, obstacles, clearance, test::any_velocity()});
}

void the_velocity_points_straight_at_the_posture_within_all_limits(void**) {
  Random random(1);
  const SidestepGains gains;
  for (int trial = 0; trial < 1000; ++trial) {
    const JointVector q_rad = random.configuration(lwa3()), goal_rad = random.configuration(lwa3());
    const NominalCommand nominal = toward(goal_rad, q_rad, gains);
    const JointVector left_rad = goal_rad - q_rad;
    const double per_s = nominal.velocity_radps.norm() / left_rad.norm();
    check_near(nominal.velocity_radps, JointVector(per_s * left_rad), 1e-12);
    assert_true(per_s > 0.0 && per_s <= gains.k_pos_per_s);
    const JointVector excess = nominal.velocity_radps.cwiseAbs() - lwa3().limits.velocity_radps;
    check(excess.maxCoeff() <= 1e-12, "%g rad/s too fast", excess.maxCoeff());
    check(nominal.tool_velocity_mps.norm() <= gains.v_max_mps + 1e-12, "%g m/s", nominal.tool_velocity_mps.norm());
    const TaskJacobian jacobian = tool_jacobian(forward_kinematics(lwa3(), q_rad), 3);
    check_near(nominal.tool_velocity_mps, Vector3(jacobian * nominal.velocity_radps), 1e-12);
  }
}

/// One joint alone, without a limit of the tool's speed: the deceleration along the way stays below the limit.
void a_joint_brakes_within_its_acceleration_limit(void**) {
  SidestepGains gains;
  gains.v_max_mps = 100.0;
  const double period_s = 1e-4, limit_radps2 = lwa3().limits.acceleration_radps2[0];
  JointVector q_rad = test::home_rad(), goal_rad = q_rad;
  goal_rad[0] += 2.0;
  double last_radps = 0.0, largest_radps2 = 0.0;
  for (int i = 0; i < 30'000; ++i) {
    const double radps = toward(goal_rad, q_rad, gains).velocity_radps[0];
    if (i > 0) largest_radps2 = std::max(largest_radps2, (last_radps - radps) / period_s);
    last_radps = radps;
    q_rad[0] += radps * period_s;
  }
  check(largest_radps2 < 0.91 * limit_radps2 && largest_radps2 > 0.8 * limit_radps2, "%g rad/s2", largest_radps2);
  check_near(q_rad, goal_rad, 1e-6);
}

void at_the_posture_the_arm_rests(void**) {
  const NominalCommand nominal = toward(test::home_rad(), test::home_rad(), SidestepGains());
  check_near(nominal.velocity_radps, JointVector(JointVector::Zero(7)), 0.0);
  assert_false(nominal.task_speed_limited);
}

void a_slower_tool_is_reported(void**) {
  SidestepGains gains;
  gains.v_max_mps = 0.1;
  const JointVector goal_rad = test::home_rad() + JointVector::Constant(7, 1.0);
  const NominalCommand nominal = toward(goal_rad, test::home_rad(), gains);
  assert_true(nominal.task_speed_limited);
  check_near(nominal.tool_velocity_mps.norm(), 0.1, 1e-12);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(the_velocity_points_straight_at_the_posture_within_all_limits),
      cmocka_unit_test(a_joint_brakes_within_its_acceleration_limit),
      cmocka_unit_test(at_the_posture_the_arm_rests),
      cmocka_unit_test(a_slower_tool_is_reported),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
