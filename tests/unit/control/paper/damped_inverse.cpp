#include "firmware/control/paper/damped_inverse.h"

#include "firmware/model/kinematics.h"
#include "tests/support/check.h"
#include "tests/support/lwa3.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::home_rad;
using test::lwa3;
using test::Random;

namespace {

PaperGains gains_of(double lambda_0, double sigma_0) {
  PaperGains gains;
  gains.lambda_0 = lambda_0;
  gains.sigma_0 = sigma_0;
  return gains;
}

/// A 3 x 7 Jacobian with these singular values in arbitrary directions.
TaskJacobian jacobian_of(double s1, double s2, double s3) {
  TaskJacobian values = TaskJacobian::Zero(3, 7);
  values(0, 0) = s1;
  values(1, 1) = s2;
  values(2, 2) = s3;
  JointMatrix rotation = JointMatrix::Identity(7, 7);
  for (int i = 0; i < 6; ++i) {
    JointMatrix one = JointMatrix::Identity(7, 7);
    const double c = std::cos(0.7 + i), s = std::sin(0.7 + i);
    one.block<2, 2>(i, i) << c, -s, s, c;
    rotation = rotation * one;
  }
  return Matrix3(Eigen::AngleAxisd(0.8, Vector3(1, 2, 3).normalized())) * values * rotation;
}

TaskJacobian random_jacobian(Random& random, int rows) {
  return tool_jacobian(forward_kinematics(lwa3(), random.configuration(lwa3())), rows);
}

void damping_equals_equation_6(void**) {
  const PaperGains gains = gains_of(0.08, 0.1);
  check_near(invert(gains, jacobian_of(1, 0.5, 0.1)).lambda, 0.0, 1e-12);
  check_near(invert(gains, jacobian_of(1, 0.5, 0.3)).lambda, 0.0, 0);
  check_near(invert(gains, jacobian_of(1, 0.5, 0.05)).lambda, 0.04, 1e-12);
  check_near(invert(gains, jacobian_of(1, 0.5, 0.025)).lambda, 0.06, 1e-12);
  check_near(invert(gains, jacobian_of(1, 0.5, 0.0)).lambda, 0.08, 1e-12);
}

void damping_is_continuous_and_grows_toward_the_singularity(void**) {
  const PaperGains gains = gains_of(0.08, 0.1);
  double last = invert(gains, jacobian_of(1, 0.5, 0.12)).lambda;
  for (double s = 0.12; s >= 0.0; s -= 1e-3) {
    const double lambda = invert(gains, jacobian_of(1, 0.5, s)).lambda;
    check(lambda >= last - 1e-12 && lambda - last <= 0.8 * 1.01e-3, "at %g: %g after %g", s, lambda, last);
    last = lambda;
  }
  check_near(last, 0.08, 1e-3);
}

/// eq (5) itself: J^T (J J^T + lambda^2 I)^-1.
void inverse_equals_equation_5_at_random_configurations(void**) {
  Random random(1);
  const PaperGains gains = gains_of(0.3, 0.4);  // damped in most configurations
  int damped = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const int rows = trial % 2 ? 3 : 6;
    const TaskJacobian j = random_jacobian(random, rows);
    const TaskInverse inverse = invert(gains, j);
    const Eigen::MatrixXd gram =
        j * j.transpose() + inverse.lambda * inverse.lambda * Eigen::MatrixXd::Identity(rows, rows);
    const Eigen::MatrixXd expected = j.transpose() * gram.ldlt().solve(Eigen::MatrixXd::Identity(rows, rows));
    if (gram.ldlt().rcond() < 1e-8) continue;
    check_near_because(Eigen::MatrixXd(inverse.damped_transposed.transpose()), expected, 1e-8, "trial %d", trial);
    const TaskVector x = TaskVector::Constant(rows, 0.3);
    check_near_because(inverse * x, Eigen::VectorXd(expected * x), 1e-8, "trial %d", trial);
    damped += inverse.lambda > 0;
  }
  check(damped > 100, "%d damped", damped);
}

void without_damping_the_task_is_met_exactly(void**) {
  Random random(2);
  for (int trial = 0; trial < 200; ++trial) {
    const TaskJacobian j = random_jacobian(random, 3);
    const TaskInverse inverse = invert(gains_of(0.0, 0.1), j);
    const TaskVector x = random.inside(-1, 1);
    if ((j * j.transpose()).determinant() < 1e-8) continue;
    check_near_because(j * (inverse * x), x, 1e-9, "trial %d", trial);
  }
}

void check_projector(const TaskJacobian& j, const JointMatrix& n, int degrees_of_freedom, const char* where) {
  check_near_because(n * n, n, 1e-9, "N N = N, %s", where);
  check_near_because(n.transpose(), n, 1e-12, "symmetric, %s", where);
  check_near_because(j * n, TaskJacobian::Zero(j.rows(), j.cols()), 1e-5, "J N = 0, %s", where);
  check_near_because(n.trace(), static_cast<double>(degrees_of_freedom), 1e-9, "degrees of freedom, %s", where);
}

void null_space_is_a_projector_at_random_configurations(void**) {
  Random random(3);
  for (int trial = 0; trial < 300; ++trial) {
    const TaskJacobian position = random_jacobian(random, 3), pose = random_jacobian(random, 6);
    check_projector(position, invert(PaperGains(), position).null_space, 4, "position");
    check_projector(pose, invert(PaperGains(), pose).null_space, 1, "pose");
    check_near(position * invert(PaperGains(), position).null_space, TaskJacobian::Zero(3, 7), 1e-12);
  }
}

void a_pose_task_at_home_leaves_only_joints_5_and_7_free(void**) {
  const TaskJacobian j = tool_jacobian(forward_kinematics(lwa3(), home_rad()), 6);
  const JointMatrix n = invert(PaperGains(), j).null_space;
  check_projector(j, n, 1, "home");
  JointVector free = JointVector::Zero(7);
  free[4] = M_SQRT1_2;
  free[6] = -M_SQRT1_2;
  check_near(n, JointMatrix(free * free.transpose()), 1e-9);
}

void singular_configurations_have_a_larger_null_space_and_finite_velocities(void**) {
  const TaskJacobian upright =
      tool_jacobian(forward_kinematics(lwa3(), JointVector::Zero(7)), 3);  // joints 2, 4, 6: one direction
  const TaskInverse inverse = invert(PaperGains(), upright);
  check_projector(upright, inverse.null_space, 6, "upright");
  check_near(inverse.lambda, PaperGains().lambda_0, 1e-9);
  check((inverse * TaskVector::Constant(3, 1.0)).allFinite(), "upright");
  check((inverse * TaskVector::Constant(3, 1.0)).norm() < 10.0, "upright");

  const TaskInverse of_zero = invert(PaperGains(), TaskJacobian::Zero(6, 7));
  check_near(of_zero.null_space, JointMatrix::Identity(7, 7), 0);
  check_near(of_zero * TaskVector::Constant(6, 1.0), JointVector::Zero(7), 0);
}

/// The elbow passes the stretched arm. Near the singularity a task velocity of 1 m/s gives at most 1 / (2 lambda).
void velocity_is_bounded_and_continuous_through_a_singularity(void**) {
  JointVector q_rad = home_rad();
  q_rad[2] = 0.3;
  JointVector last;
  for (double elbow_rad = -0.4; elbow_rad <= 0.4; elbow_rad += 1e-3) {
    q_rad[3] = elbow_rad;
    const LinkPoses poses = forward_kinematics(lwa3(), q_rad);
    const JointVector qd_radps =
        invert(PaperGains(), tool_jacobian(poses, 3)) * TaskVector(poses.tool_position.normalized());
    check(qd_radps.norm() < 15.0, "at %g: %g rad/s", elbow_rad, qd_radps.norm());
    if (last.size() > 0)
      check((qd_radps - last).norm() < 0.5, "at %g: a jump of %g rad/s", elbow_rad, (qd_radps - last).norm());
    last = qd_radps;
  }
}

void damped_solve_is_the_damped_inverse_of_three_rows(void**) {
  Random random(4);
  for (int trial = 0; trial < 500; ++trial) {
    PointJacobian a(3, 7);
    for (int i = 0; i < 7; ++i) a.col(i) = random.inside(-1, 1);
    if (trial % 3 == 0) a.row(1) = 2 * a.row(0);
    if (trial % 7 == 0) a.setZero();
    const double lambda = random.uniform(0.01, 0.2);
    const Vector3 b = random.inside(-1, 1);
    const Matrix3 gram = a * a.transpose() + lambda * lambda * Matrix3::Identity();
    const JointVector expected = a.transpose() * (gram.inverse() * b);
    check_near_because(damped_solve(a, lambda, b), expected, 1e-8, "trial %d", trial);
  }
  check_near(damped_solve(PointJacobian::Zero(3, 7), 0.05, Vector3(1, 2, 3)), JointVector::Zero(7), 0);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(damping_equals_equation_6),
      cmocka_unit_test(damping_is_continuous_and_grows_toward_the_singularity),
      cmocka_unit_test(inverse_equals_equation_5_at_random_configurations),
      cmocka_unit_test(without_damping_the_task_is_met_exactly),
      cmocka_unit_test(null_space_is_a_projector_at_random_configurations),
      cmocka_unit_test(a_pose_task_at_home_leaves_only_joints_5_and_7_free),
      cmocka_unit_test(singular_configurations_have_a_larger_null_space_and_finite_velocities),
      cmocka_unit_test(velocity_is_bounded_and_continuous_through_a_singularity),
      cmocka_unit_test(damped_solve_is_the_damped_inverse_of_three_rows),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
