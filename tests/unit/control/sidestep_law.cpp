#include "firmware/control/sidestep_law.h"

#include "tests/support/check.h"
#include "tests/support/lwa3.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::home_rad;
using test::lwa3;
using test::Random;

namespace {

const SidestepGains kGains;

NominalCommand nominal_at(const JointVector& q_rad, const Target& target,
                          const VelocityRange& range = test::any_velocity()) {
  const LinkPoses poses = forward_kinematics(lwa3(), q_rad);
  const JointVector at_rest = JointVector::Zero(q_rad.size());
  const TaskJacobian jacobian = tool_jacobian(poses, target.tracks_orientation ? 6 : 3);
  const ObstacleView no_obstacles{};
  const Clearance clearance{};
  const LawInput input{lwa3(), poses, jacobian, q_rad, at_rest, target, no_obstacles, clearance, range};
  return sidestep_law(kGains, input, away_from_limits(kGains, input));
}

/// A target that the tool has already reached.
Target target_at(const JointVector& q_rad, bool with_orientation) {
  const LinkPoses poses = forward_kinematics(lwa3(), q_rad);
  Target target;
  target.position_m = poses.tool_position;
  target.tracks_orientation = with_orientation;
  target.orientation = Quaternion(poses.tool_rotation);
  return target;
}

double smallest_singular_value(const JointVector& q_rad, int rows) {
  const TaskJacobian jacobian = weighted_task(tool_jacobian(forward_kinematics(lwa3(), q_rad), rows));
  return Eigen::JacobiSVD<Eigen::MatrixXd>(jacobian).singularValues()[rows - 1];
}

/// A random configuration without damping by the law.
JointVector regular_configuration(Random& random, int rows) {
  JointVector q_rad = random.configuration(lwa3());
  while (smallest_singular_value(q_rad, rows) < kGains.sigma_0) q_rad = random.configuration(lwa3());
  return q_rad;
}

TaskVector tool_motion(const JointVector& q_rad, const NominalCommand& nominal, int rows) {
  return tool_jacobian(forward_kinematics(lwa3(), q_rad), rows) * nominal.velocity_radps;
}

void at_a_still_target_the_nominal_velocity_does_not_move_the_tool(void**) {
  Random random(1);
  for (int trial = 0; trial < 1000; ++trial) {
    const bool rotated = trial % 2;
    const int rows = rotated ? 6 : 3;
    const JointVector q_rad = regular_configuration(random, rows);
    const NominalCommand nominal = nominal_at(q_rad, target_at(q_rad, rotated));
    check_near(nominal.damping, 0.0, 0.0);
    check_near_because(tool_motion(q_rad, nominal, rows), TaskVector(TaskVector::Zero(rows)), 1e-9, "trial %d", trial);
  }
}

void at_a_moving_target_the_tool_moves_with_it(void**) {
  Random random(2);
  for (int trial = 0; trial < 1000; ++trial) {
    const bool rotated = trial % 2;
    const int rows = rotated ? 6 : 3;
    const JointVector q_rad = regular_configuration(random, rows);
    Target target = target_at(q_rad, rotated);
    target.velocity_mps = random.inside(-2, 2);  // the target's own speed is not limited
    target.angular_velocity_radps = random.inside(-2, 2);
    TaskVector expected(rows);
    expected.head<3>() = target.velocity_mps;
    if (rotated) expected.tail<3>() = target.angular_velocity_radps;
    check_near_because(tool_motion(q_rad, nominal_at(q_rad, target), rows), expected, 1e-9, "trial %d", trial);
  }
}

void toward_a_target_the_tool_moves_straight_within_its_speed_limit(void**) {
  Random random(3);
  for (int trial = 0; trial < 500; ++trial) {
    const JointVector q_rad = regular_configuration(random, 3);
    Target target = target_at(q_rad, false);
    const double distance_m = random.uniform(0.01, 0.5);
    const Vector3 direction = random.direction();
    target.position_m += distance_m * direction;
    const NominalCommand nominal = nominal_at(q_rad, target);
    const double speed_mps = std::min(kGains.v_max_mps, kGains.k_pos_per_s * distance_m);
    check_near_because(tool_motion(q_rad, nominal, 3), TaskVector(speed_mps * direction), 1e-9, "trial %d", trial);
    assert_int_equal(nominal.task_speed_limited, kGains.k_pos_per_s * distance_m > kGains.v_max_mps);
  }
}

void toward_an_orientation_the_tool_turns_by_the_shortest_rotation(void**) {
  Random random(4);
  for (int trial = 0; trial < 500; ++trial) {
    const JointVector q_rad = regular_configuration(random, 6);
    Target target = target_at(q_rad, true);
    const Vector3 axis = random.direction();
    const double angle_rad = random.uniform(0.0, 3.0);
    target.orientation = Quaternion(Eigen::AngleAxisd(angle_rad, axis)) * target.orientation;
    if (trial % 2) target.orientation.coeffs() *= -1.0;  // the same orientation
    TaskVector expected = TaskVector::Zero(6);
    expected.tail<3>() = kGains.k_ori_per_s * angle_rad * axis;
    check_near_because(tool_motion(q_rad, nominal_at(q_rad, target), 6), expected, 1e-6, "trial %d", trial);
  }
}

/// Straight lines in joint space through singular configurations: the stretched arm, and home with its straight wrist.
void through_singular_configurations_the_nominal_velocity_is_continuous(void**) {
  Random random(5);
  for (int trial = 0; trial < 40; ++trial) {
    const JointVector through_rad = trial % 2 ? home_rad() : JointVector(JointVector::Zero(7));
    const JointVector direction = random.joints(7, -1, 1).normalized();
    Target target = target_at(through_rad, trial % 4 > 1);
    target.position_m += random.inside(-0.3, 0.3);
    target.velocity_mps = random.inside(-0.5, 0.5);
    const double step_rad = 1e-4, steepest_per_s = 2000.0;  // v / lambda_0^2 = 400/s for each m/s
    JointVector last_radps;
    for (int i = -1000; i <= 1000; ++i) {
      const JointVector q_rad = through_rad + i * step_rad * direction;
      const JointVector nominal_radps = nominal_at(q_rad, target).velocity_radps;
      check(nominal_radps.allFinite() && nominal_radps.norm() < 100.0, "trial %d, step %d: %g rad/s", trial, i,
            nominal_radps.norm());
      if (i > -1000)
        check((nominal_radps - last_radps).norm() <= steepest_per_s * step_rad, "trial %d, step %d: jumps by %g rad/s",
              trial, i, (nominal_radps - last_radps).norm());
      last_radps = nominal_radps;
    }
  }
}

/// Largest ratio of a joint's position to its limit.
double largest_share_of_limit(const JointVector& q_rad) {
  const JointLimits& limits = lwa3().limits;
  return q_rad.cwiseQuotient(limits.upper_rad).cwiseAbs().maxCoeff();
}

void joints_near_their_limits_return_while_the_tool_stays(void**) {
  Random random(6);
  for (int trial = 0; trial < 20; ++trial) {
    JointVector q_rad = 0.5 * random.configuration(lwa3());
    const int joint = 2 * random.index(4);  // rolls: the tool can stay while they turn
    q_rad[joint] = 0.99 * lwa3().limits.upper_rad[joint];
    if (smallest_singular_value(q_rad, 3) < 2.0 * kGains.sigma_0) continue;
    const Target target = target_at(q_rad, false);
    const double before = largest_share_of_limit(q_rad);
    for (int cycle = 0; cycle < 500; ++cycle) q_rad += 0.01 * nominal_at(q_rad, target).velocity_radps;
    check(largest_share_of_limit(q_rad) < before - 0.02, "trial %d: from %g to %g of the range", trial, before,
          largest_share_of_limit(q_rad));
    check_near_because(forward_kinematics(lwa3(), q_rad).tool_position, target.position_m, 1e-3, "trial %d", trial);
  }
}

/// Joint by joint: the one that moves most is held; the six others follow the moving pose.
void the_other_joints_make_up_for_one_at_its_limit(void**) {
  Random random(7);
  int checked = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    const JointVector q_rad = regular_configuration(random, 6);
    Target target = target_at(q_rad, true);
    target.velocity_mps = random.inside(-0.3, 0.3);
    target.angular_velocity_radps = random.inside(-0.5, 0.5);
    const NominalCommand free = nominal_at(q_rad, target);
    Eigen::Index most = 0;
    free.velocity_radps.cwiseAbs().maxCoeff(&most);
    TaskJacobian others = weighted_task(tool_jacobian(forward_kinematics(lwa3(), q_rad), 6));
    others.col(most).setZero();
    if (Eigen::JacobiSVD<Eigen::MatrixXd>(others).singularValues()[5] < kGains.sigma_0) continue;
    ++checked;
    VelocityRange range = test::any_velocity();
    range.lower_radps[most] = -0.1;
    range.upper_radps[most] = 0.1;
    const NominalCommand bounded = nominal_at(q_rad, target, range);
    check(std::abs(bounded.velocity_radps[most]) <= 0.1 + 1e-12, "trial %d: beyond the limit", trial);
    check_near_because(tool_motion(q_rad, bounded, 6), tool_motion(q_rad, free, 6), 1e-3, "trial %d", trial);
  }
  check(checked > 50, "%d trials", checked);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(at_a_still_target_the_nominal_velocity_does_not_move_the_tool),
      cmocka_unit_test(at_a_moving_target_the_tool_moves_with_it),
      cmocka_unit_test(toward_a_target_the_tool_moves_straight_within_its_speed_limit),
      cmocka_unit_test(toward_an_orientation_the_tool_turns_by_the_shortest_rotation),
      cmocka_unit_test(through_singular_configurations_the_nominal_velocity_is_continuous),
      cmocka_unit_test(joints_near_their_limits_return_while_the_tool_stays),
      cmocka_unit_test(the_other_joints_make_up_for_one_at_its_limit),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
