#include "firmware/control/task_compatibility.h"

#include "tests/support/check.h"
#include "tests/support/lwa3.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::lwa3;
using test::Random;

namespace {

constexpr double kGain_s = 10.0, kDamping_mps = 0.1;

const Arm& arm_on_a_lift() {
  static const Arm arm = load_arm("tests/data/lift_arm.urdf", "mast", "tool");
  return arm;
}

JointVector toward(const Arm& arm, const JointVector& q_rad, const Target& target) {
  const LinkPoses poses = forward_kinematics(arm, q_rad);
  const JointVector at_rest = JointVector::Zero(arm.joints);
  const TaskJacobian jacobian = tool_jacobian(poses, target.tracks_orientation ? 6 : 3);
  const ObstacleView no_obstacles{};
  const Clearance clearance{};
  return toward_task_compatibility(
      {arm, poses, jacobian, q_rad, at_rest, target, no_obstacles, clearance, test::any_velocity()});
}

Target moving_pose(Random& random, double speed) {
  Target target;
  target.tracks_orientation = true;
  target.velocity_mps = random.inside(-speed, speed);
  target.angular_velocity_radps = 2.0 * random.inside(-speed, speed);
  return target;
}

/// D: the weighted Jacobian in shares of the velocity limits.
Eigen::MatrixXd scaled_task(const Arm& arm, const JointVector& q_rad) {
  const Eigen::MatrixXd weighted = weighted_task(tool_jacobian(forward_kinematics(arm, q_rad), 6));
  return weighted * arm.limits.velocity_radps.asDiagonal();
}

Eigen::MatrixXd damped_gram(const Eigen::MatrixXd& scaled) {
  return scaled * scaled.transpose() + kDamping_mps * kDamping_mps * Eigen::MatrixXd::Identity(6, 6);
}

/// Half the sum of the squared joint speeds that the twist takes, in shares of the limits.
double effort(const Arm& arm, const JointVector& q_rad, const Target& target) {
  Eigen::VectorXd twist(6);
  twist << target.velocity_mps, kTurnWeight_m * target.angular_velocity_radps;
  return 0.5 * twist.dot(damped_gram(scaled_task(arm, q_rad)).fullPivLu().solve(twist));
}

/// The gradient by central differences, in the null space.
Eigen::VectorXd expected_velocity(const Arm& arm, const JointVector& q_rad, const Target& target) {
  constexpr double kStep_rad = 1e-5;
  const Eigen::VectorXd limit_radps = arm.limits.velocity_radps;
  Eigen::VectorXd share(arm.joints);
  for (int i = 0; i < arm.joints; ++i) {
    JointVector above = q_rad, below = q_rad;
    above[i] += kStep_rad;
    below[i] -= kStep_rad;
    const double gradient = (effort(arm, above, target) - effort(arm, below, target)) / (2.0 * kStep_rad);
    share[i] = -kGain_s * limit_radps[i] * gradient;
  }
  const Eigen::MatrixXd scaled = scaled_task(arm, q_rad);
  share -= scaled.transpose() * damped_gram(scaled).fullPivLu().solve(scaled * share);
  return limit_radps.cwiseProduct(share / std::max(1.0, share.cwiseAbs().maxCoeff()));
}

void the_velocity_is_down_the_gradient_of_the_joint_speeds_in_the_null_space(void**) {
  Random random(1);
  for (const Arm* arm : {&lwa3(), &arm_on_a_lift()})
    for (int trial = 0; trial < 500; ++trial) {
      const JointVector q_rad = random.configuration(*arm);
      const Target target = moving_pose(random, trial % 2 ? 0.02 : 1.0);
      const JointVector expected = expected_velocity(*arm, q_rad, target);
      check_near_because(toward(*arm, q_rad, target), expected, 1e-5, "%d joints, trial %d", arm->joints, trial);
    }
}

void no_joint_exceeds_its_velocity_limit_and_some_reach_it(void**) {
  Random random(2);
  double largest = 0.0;
  for (int trial = 0; trial < 1000; ++trial) {
    const JointVector share = toward(lwa3(), random.configuration(lwa3()), moving_pose(random, 2.0))
                                  .cwiseQuotient(lwa3().limits.velocity_radps);
    check(share.cwiseAbs().maxCoeff() <= 1.0 + 1e-12, "trial %d", trial);
    largest = std::max(largest, share.cwiseAbs().maxCoeff());
  }
  check_near(largest, 1.0, 1e-12);
}

void a_pose_at_rest_and_a_position_change_nothing(void**) {
  Random random(3);
  for (int trial = 0; trial < 100; ++trial) {
    const JointVector q_rad = random.configuration(lwa3()), zero = JointVector::Zero(7);
    Target target = moving_pose(random, 1.0);
    target.tracks_orientation = false;
    check_near(toward(lwa3(), q_rad, target), zero, 0.0);
    target = moving_pose(random, 0.0);
    check_near(toward(lwa3(), q_rad, target), zero, 0.0);
  }
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(the_velocity_is_down_the_gradient_of_the_joint_speeds_in_the_null_space),
      cmocka_unit_test(no_joint_exceeds_its_velocity_limit_and_some_reach_it),
      cmocka_unit_test(a_pose_at_rest_and_a_position_change_nothing),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
