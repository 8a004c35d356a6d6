#include "host/sim/sensing.h"

#include "tests/support/check.h"

using namespace sidestep::sim;

namespace {

constexpr int kMany = 20000;

void without_a_specification_the_values_are_unchanged(void**) {
  Sensing sensing({});
  const JointVector q_rad = JointVector::Constant(7, 0.3);
  for (int i = 0; i < 100; ++i) check_near(sensing.joints(q_rad).value(), q_rad, 0.0);
  Obstacle obstacle;
  obstacle.motion.position_m = Eigen::Vector3d(1, 2, 3);
  check_near(sensing.obstacles({obstacle}).value()[0].motion.position_m, obstacle.motion.position_m, 0.0);
  assert_true(sensing.target({}).has_value());
}

void noise_has_the_specified_deviation_and_zero_mean(void**) {
  Sensing sensing({0.01, 0.02, 0.0, 3});
  double joint_sum = 0.0, joint_squares = 0.0, obstacle_squares = 0.0;
  for (int i = 0; i < kMany; ++i) {
    const double error_rad = sensing.joints(JointVector::Constant(7, 0.3)).value()[i % 7] - 0.3;
    joint_sum += error_rad;
    joint_squares += error_rad * error_rad;
    const double error_m = sensing.obstacles({Obstacle{}}).value()[0].motion.position_m[i % 3];
    obstacle_squares += error_m * error_m;
  }
  check_near(joint_sum / kMany, 0.0, 3e-4);
  check_near(std::sqrt(joint_squares / kMany), 0.01, 3e-4);
  check_near(std::sqrt(obstacle_squares / kMany), 0.02, 6e-4);
}

void the_specified_share_of_each_kind_of_message_is_lost(void**) {
  Sensing sensing({0.0, 0.0, 0.1, 5});
  int joints = 0, targets = 0, obstacles = 0;
  for (int i = 0; i < kMany; ++i) {
    joints += !sensing.joints(JointVector::Zero(7));
    targets += !sensing.target({});
    obstacles += !sensing.obstacles({});
  }
  for (const int lost : {joints, targets, obstacles}) check_near(1.0 * lost / kMany, 0.1, 0.01);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(without_a_specification_the_values_are_unchanged),
      cmocka_unit_test(noise_has_the_specified_deviation_and_zero_mean),
      cmocka_unit_test(the_specified_share_of_each_kind_of_message_is_lost),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
