#include "firmware/control/paper/attraction.h"

#include "tests/support/check.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::Random;

namespace {

void force_is_a_spring_and_a_damper_to_the_target(void**) {
  PaperGains gains;
  gains.k_pos_per_s2 = 20.0;
  gains.k_vel_per_s = 9.0;
  Target target;
  target.position_m = Vector3(1, 2, 3);
  target.velocity_mps = Vector3(0.1, 0.2, 0.3);
  const Vector3 force = attraction(gains, target, Vector3(0.5, 2, 3.5), Vector3(0.1, 0.5, 0));
  check_near(force, Vector3(10, -2.7, -7.3), 1e-12);
}

void force_vanishes_at_the_target_with_its_velocity(void**) {
  Target target;
  target.position_m = Vector3(1, 2, 3);
  target.velocity_mps = Vector3(0.1, 0.2, 0.3);
  check_near(attraction(PaperGains(), target, target.position_m, target.velocity_mps), Vector3(0, 0, 0), 0);
}

void a_quarter_turn_of_error_is_corrected_about_its_axis(void**) {
  PaperGains gains;
  gains.k_ori_per_s = 4.0;
  Target target;
  target.orientation = Quaternion(Eigen::AngleAxisd(M_PI / 2, Vector3::UnitZ()));
  target.angular_velocity_radps = Vector3(0.1, 0, 0);
  const Vector3 rate = orientation_rate(gains, target, Matrix3::Identity());
  check_near(rate, Vector3(0.1, 0, 2 * M_PI), 1e-12);
}

void at_the_targets_orientation_the_rate_is_the_targets_own(void**) {
  Target target;
  target.orientation = Quaternion(Eigen::AngleAxisd(0.7, Vector3(1, 2, 3).normalized()));
  target.angular_velocity_radps = Vector3(0.1, -0.2, 0.3);
  const Vector3 rate = orientation_rate(PaperGains(), target, target.orientation.toRotationMatrix());
  check_near(rate, target.angular_velocity_radps, 1e-7);
}

/// From any orientation the rate is k_ori times the angle to the target. A quaternion and its negative are one
/// orientation.
void the_rate_reduces_the_angle_to_the_target(void**) {
  Random random(1);
  PaperGains gains;
  for (int trial = 0; trial < 1000; ++trial) {
    Target target;
    target.orientation = random.turn();
    const Quaternion tool = random.turn();
    const double angle = tool.angularDistance(target.orientation);
    if (angle > M_PI - 1e-3) continue;
    const Vector3 rate = orientation_rate(gains, target, tool.toRotationMatrix());
    check_near_because(rate.norm(), gains.k_ori_per_s * angle, 1e-6, "trial %d", trial);
    const double dt_s = 0.01;
    const Quaternion later = Quaternion(Eigen::AngleAxisd(rate.norm() * dt_s, rate.normalized())) * tool;
    check_near_because(later.angularDistance(target.orientation), angle * (1 - gains.k_ori_per_s * dt_s), 1e-6,
                       "trial %d", trial);
    target.orientation.coeffs() *= -1;
    check_near_because(orientation_rate(gains, target, tool.toRotationMatrix()), rate, 1e-9, "trial %d", trial);
  }
}

void half_a_turn_of_error_gives_a_finite_rate(void**) {
  Target target;
  for (const Vector3& axis : {Vector3(1, 0, 0), Vector3(0, 1, 0), Vector3(0, 0, 1), Vector3(0.6, 0, 0.8)}) {
    target.orientation = Quaternion(Eigen::AngleAxisd(M_PI, axis));
    const Vector3 rate = orientation_rate(PaperGains(), target, Matrix3::Identity());
    check_near(rate.norm(), PaperGains().k_ori_per_s * M_PI, 1e-6);
    check_near(std::abs(rate.normalized().dot(axis)), 1.0, 1e-6);
  }
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(force_is_a_spring_and_a_damper_to_the_target),
      cmocka_unit_test(force_vanishes_at_the_target_with_its_velocity),
      cmocka_unit_test(a_quarter_turn_of_error_is_corrected_about_its_axis),
      cmocka_unit_test(at_the_targets_orientation_the_rate_is_the_targets_own),
      cmocka_unit_test(the_rate_reduces_the_angle_to_the_target),
      cmocka_unit_test(half_a_turn_of_error_gives_a_finite_rate),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
