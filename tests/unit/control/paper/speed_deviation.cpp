#include "firmware/control/paper/speed_deviation.h"

#include "tests/support/check.h"
#include "tests/support/lwa3.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::home_rad;
using test::lwa3;
using test::Random;

namespace {

/// eq (19) as the paper prints it, with its d_1 = 0.3 and d_2 = 0.1.
double printed_beta(double d_0_m) {
  if (d_0_m < 0.1) return 1.0;
  if (d_0_m >= 0.3) return 0.0;
  return 1.0 + std::cos(M_PI * (d_0_m + 0.1) / (2 * (0.3 - 0.1)));
}

PaperGains gains_of(double d_m, double d_1, double d_2) {
  PaperGains gains;
  gains.d_m_m = d_m;
  gains.d_1_m = d_1;
  gains.d_2_m = d_2;
  return gains;
}

void priority_equals_equation_19(void**) {
  const PaperGains gains = gains_of(0.3, 0.3, 0.1);
  for (double d_0_m = 0.0; d_0_m < 0.4; d_0_m += 1e-3)
    check_near_because(task_priority(gains, d_0_m), printed_beta(d_0_m), 1e-12, "at %g", d_0_m);
  check_near(task_priority(gains, 0.2), 1 - M_SQRT1_2, 1e-12);
}

void priority_and_share_fall_continuously_from_one_to_zero(void**) {
  for (const auto& [d_1, d_2] : {std::pair{0.3, 0.1}, {0.3, 0.0}, {0.5, 0.4}, {1.0, 0.05}}) {
    const PaperGains gains = gains_of(d_1, d_1, d_2);
    const double step_m = 1e-4;
    check_near(task_priority(gains, d_2), 1.0, 1e-12);
    check_near(task_priority(gains, 0.0), 1.0, 1e-12);
    check_near(task_priority(gains, d_1), 0.0, 0);
    check_near(deviation_share(gains, 0.0), 1.0, 0);
    check_near(deviation_share(gains, d_1), 0.0, 0);
    for (double d_0_m = 0.0; d_0_m < d_1 + 0.1; d_0_m += step_m) {
      const double beta_drop = task_priority(gains, d_0_m) - task_priority(gains, d_0_m + step_m);
      const double alpha_drop = deviation_share(gains, d_0_m) - deviation_share(gains, d_0_m + step_m);
      check(beta_drop >= 0 && beta_drop <= 1.6 * step_m / (d_1 - d_2), "beta at %g drops by %g", d_0_m, beta_drop);
      check(alpha_drop >= 0 && alpha_drop <= 1.6 * step_m / d_1, "alpha at %g drops by %g", d_0_m, alpha_drop);
    }
  }
}

void share_equals_equation_17(void**) {
  const PaperGains gains = gains_of(0.3, 0.3, 0.1);
  check_near(deviation_share(gains, 0.1), 0.5, 1e-12);  // 1 - sin(pi/6)
  check_near(deviation_share(gains, 0.15), 1 - M_SQRT1_2, 1e-12);
  check_near(deviation_share(gains, 10.0), 0.0, 0);
  check(deviation_share(gains, -0.1) <= 1.0, "the share of a negative distance is not clamped");
}

Proximity near_forearm(const LinkPoses& poses, double distance_m) {
  Proximity nearest;
  nearest.shape = 2;  // the forearm
  nearest.obstacle = 0;
  nearest.on_arm = 0.5 * (poses.origin[4] + poses.origin[5]);
  nearest.normal = Vector3(0.6, 0, 0.8);
  nearest.on_obstacle = nearest.on_arm - distance_m * nearest.normal;
  nearest.axis_distance_m = distance_m;
  return nearest;
}

/// The deviation lies in the null space of the task.
void deviation_does_not_move_the_tool(void**) {
  Random random(1);
  for (int trial = 0; trial < 200; ++trial) {
    const LinkPoses poses = forward_kinematics(lwa3(), random.configuration(lwa3()));
    const TaskJacobian j = tool_jacobian(poses, trial % 2 ? 3 : 6);
    const TaskInverse inverse = invert(PaperGains(), j);
    const JointVector task = random.joints(7, -1, 1);
    const JointVector deviation =
        speed_deviation(PaperGains(), lwa3(), poses, near_forearm(poses, 0.12), inverse, task);
    check_near_because(j * deviation, TaskVector::Zero(j.rows()), 1e-4 * std::max(1.0, deviation.norm()), "trial %d",
                       trial);
  }
}

/// Term by term: beta A^T (A A^T + lambda_n^2 I)^-1 (alpha x_m n - J_0 q'_task), A = J_0 N.
void deviation_equals_the_second_term_of_equation_18(void**) {
  PaperGains gains = gains_of(0.3, 0.3, 0.1);
  gains.x_m_mps = 0.5;
  gains.lambda_n = 0.05;
  JointVector q_rad = home_rad();
  q_rad[0] = 0.4;
  q_rad[2] = -0.3;
  const LinkPoses poses = forward_kinematics(lwa3(), q_rad);
  const TaskInverse inverse = invert(gains, tool_jacobian(poses, 3));
  const Proximity nearest = near_forearm(poses, 0.15);
  const JointVector task = JointVector::LinSpaced(7, -0.3, 0.3);

  const PointJacobian j_0 = point_jacobian(poses, 5, nearest.on_arm);
  const PointJacobian a = j_0 * inverse.null_space;
  const Vector3 x_0 = (1 - M_SQRT1_2) * 0.5 * nearest.normal;
  const Matrix3 gram = a * a.transpose() + 0.0025 * Matrix3::Identity();
  const double beta = 1 - std::sin(M_PI / 8);
  const JointVector expected = beta * (a.transpose() * (gram.inverse() * (x_0 - j_0 * task)));
  check_near(speed_deviation(gains, lwa3(), poses, nearest, inverse, task), expected, 1e-9);
  assert_true(expected.norm() > 0.05);
}

void at_home_with_a_pose_task_the_deviation_is_zero(void**) {
  const LinkPoses poses = forward_kinematics(lwa3(), home_rad());
  const TaskInverse inverse = invert(PaperGains(), tool_jacobian(poses, 6));
  const JointVector deviation =
      speed_deviation(PaperGains(), lwa3(), poses, near_forearm(poses, 0.0), inverse, JointVector::Zero(7));
  check_near(deviation, JointVector::Zero(7), 1e-9);
}

void a_far_obstacle_causes_no_deviation(void**) {
  const LinkPoses poses = forward_kinematics(lwa3(), home_rad());
  const TaskInverse inverse = invert(PaperGains(), tool_jacobian(poses, 3));
  const JointVector task = JointVector::Constant(7, 0.5);
  check_near(speed_deviation(PaperGains(), lwa3(), poses, near_forearm(poses, 0.3), inverse, task),
             JointVector::Zero(7), 0);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(priority_equals_equation_19),
      cmocka_unit_test(priority_and_share_fall_continuously_from_one_to_zero),
      cmocka_unit_test(share_equals_equation_17),
      cmocka_unit_test(deviation_does_not_move_the_tool),
      cmocka_unit_test(deviation_equals_the_second_term_of_equation_18),
      cmocka_unit_test(at_home_with_a_pose_task_the_deviation_is_zero),
      cmocka_unit_test(a_far_obstacle_causes_no_deviation),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
