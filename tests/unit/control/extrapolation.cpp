#include "firmware/control/extrapolation.h"

#include "tests/support/check.h"
#include "tests/support/lwa3.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::lwa3;
using test::Random;

namespace {

/// The velocities of the tool at random joint velocities within the limits.
void a_target_that_the_arm_can_follow_keeps_its_velocity(void**) {
  Random random(1);
  const Arm& arm = lwa3();
  for (int trial = 0; trial < 10000; ++trial) {
    const LinkPoses poses = forward_kinematics(arm, random.configuration(arm));
    JointVector qd_radps = random.joints(7, -1, 1).cwiseProduct(arm.limits.velocity_radps);
    if (trial % 2 == 0) qd_radps = qd_radps.cwiseSign().cwiseProduct(arm.limits.velocity_radps * (1.0 - 1e-9));
    const TaskVector twist = tool_jacobian(poses, 6) * qd_radps;
    Target target;
    target.velocity_mps = twist.head<3>();
    target.angular_velocity_radps = twist.tail<3>();
    const Target bounded = bounded_speed(arm, tool_jacobian(poses, 6), target);
    check_near(bounded.velocity_mps, target.velocity_mps, 0);
    check_near(bounded.angular_velocity_radps, target.angular_velocity_radps, 0);
  }
}

/// The bound along a direction is that of the joint velocities at their limits, each with the sign that helps.
void a_faster_target_counts_with_the_largest_speed_of_the_tool_along_its_direction(void**) {
  Random random(2);
  const Arm& arm = lwa3();
  for (int trial = 0; trial < 1000; ++trial) {
    const LinkPoses poses = forward_kinematics(arm, random.configuration(arm));
    const TaskJacobian jacobian = tool_jacobian(poses, 6);
    Target target;
    target.velocity_mps = 1000.0 * random.direction();
    target.angular_velocity_radps = 1000.0 * random.direction();
    const Target bounded = bounded_speed(arm, tool_jacobian(poses, 6), target);
    const auto largest = [&](const PointJacobian& rows, const Vector3& direction) {
      JointVector best_radps = arm.limits.velocity_radps;
      for (int i = 0; i < 7; ++i) best_radps[i] *= direction.dot(rows.col(i)) < 0.0 ? -1.0 : 1.0;
      return direction.dot(rows * best_radps);
    };
    const Vector3 n = target.velocity_mps.normalized(), m = target.angular_velocity_radps.normalized();
    check_near(bounded.velocity_mps, (n * largest(jacobian.topRows<3>(), n)).eval(), 1e-9);
    check_near(bounded.angular_velocity_radps, (m * largest(jacobian.bottomRows<3>(), m)).eval(), 1e-9);
  }
}

void a_target_at_rest_stays_at_rest(void**) {
  const LinkPoses poses = forward_kinematics(lwa3(), test::home_rad());
  const Target bounded = bounded_speed(lwa3(), tool_jacobian(poses, 6), Target{});
  check_near(bounded.velocity_mps, Vector3::Zero().eval(), 0);
  check_near(bounded.angular_velocity_radps, Vector3::Zero().eval(), 0);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_target_that_the_arm_can_follow_keeps_its_velocity),
      cmocka_unit_test(a_faster_target_counts_with_the_largest_speed_of_the_tool_along_its_direction),
      cmocka_unit_test(a_target_at_rest_stays_at_rest),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
