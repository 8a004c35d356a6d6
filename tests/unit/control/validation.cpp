#include "firmware/control/validation.h"

#include <functional>
#include <limits>
#include <vector>

#include "firmware/control/types/inputs.h"
#include "tests/support/check.h"

using namespace sidestep;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

ArmState good_arm() {
  return {1, JointVector::Constant(7, 0.5), JointVector::Constant(7, -0.1)};
}

Target good_target() {
  Target target;
  target.position_m = Vector3(0.3, -0.2, 0.9);
  target.velocity_mps = Vector3(0.1, 0, -0.2);
  target.tracks_orientation = true;
  target.orientation = Quaternion(Eigen::AngleAxisd(0.4, Vector3::UnitX()));
  return target;
}

Obstacle good_obstacle() {
  Obstacle obstacle;
  obstacle.capsule = {Vector3(1, 0, 0), Vector3(1, 0, 1), 0.1};
  return obstacle;
}

void possible_values_are_plausible(void**) {
  assert_true(plausible(good_arm(), 7));
  assert_true(plausible(good_target()));
  assert_true(plausible(good_obstacle()));
  assert_true(plausible(Obstacle()));  // a point at rest
}

void an_arm_state_with_an_impossible_number_is_rejected(void**) {
  for (const double bad : {kNan, kInfinity, -kInfinity, 1e4, -1e300}) {
    for (int i = 0; i < 7; ++i) {
      ArmState position = good_arm(), velocity = good_arm();
      position.position_rad[i] = bad;
      velocity.velocity_radps[i] = bad;
      check(!plausible(position, 7) && !plausible(velocity, 7), "joint %d: %g", i, bad);
    }
  }
}

void an_arm_state_with_a_wrong_number_of_joints_is_rejected(void**) {
  for (int joints = 0; joints <= kMaxJoints; ++joints) assert_int_equal(plausible(good_arm(), joints), joints == 7);
  ArmState uneven = good_arm();
  uneven.velocity_radps = JointVector::Zero(6);
  assert_false(plausible(uneven, 7));
}

void a_target_with_an_impossible_number_is_rejected(void**) {
  for (const double bad : {kNan, kInfinity, -kInfinity, 1e4, -1e300}) {
    for (int i = 0; i < 3; ++i) {
      Target position = good_target(), velocity = good_target(), turning = good_target();
      position.position_m[i] = bad;
      velocity.velocity_mps[i] = bad;
      turning.angular_velocity_radps[i] = bad;
      check(!plausible(position) && !plausible(velocity) && !plausible(turning), "element %d: %g", i, bad);
      turning.tracks_orientation = false;
      check(plausible(turning) == std::isfinite(bad), "unused element %d: %g", i, bad);
    }
    for (int i = 0; i < 4; ++i) {
      Target target = good_target();
      target.orientation.coeffs()[i] = bad;
      check(!plausible(target), "quaternion %d: %g", i, bad);
    }
  }
}

void an_orientation_that_is_no_unit_quaternion_is_rejected(void**) {
  for (const double length : {0.0, 0.5, 0.99, 0.9995, 1.0, 1.0005, 1.01, 2.0}) {
    Target target = good_target();
    target.orientation.coeffs() *= length;
    check(plausible(target) == (std::abs(length - 1.0) < 1e-3), "length %g", length);
    target.tracks_orientation = false;
    check(plausible(target), "unused quaternion of length %g", length);
  }
}

void an_obstacle_with_an_impossible_number_is_rejected(void**) {
  const std::vector<std::function<double&(Obstacle&)>> numbers = {
      [](Obstacle& o) -> double& { return o.capsule.start.y(); },
      [](Obstacle& o) -> double& { return o.capsule.end.z(); },
      [](Obstacle& o) -> double& { return o.capsule.radius_m; },
      [](Obstacle& o) -> double& { return o.velocity_mps.x(); },
      [](Obstacle& o) -> double& { return o.angular_velocity_radps.z(); }};
  for (size_t i = 0; i < numbers.size(); ++i) {
    for (const double bad : {kNan, kInfinity, -kInfinity, 1e4, -1e300}) {
      Obstacle obstacle = good_obstacle();
      numbers[i](obstacle) = bad;
      check(!plausible(obstacle), "number %zu: %g", i, bad);
    }
  }
  Obstacle negative_radius = good_obstacle();
  negative_radius.capsule.radius_m = -1e-9;
  assert_false(plausible(negative_radius));
}

void a_message_is_fresh_from_its_receipt_to_its_age_limit(void**) {
  const Target target;
  const Latest<Target> latest{&target, 10.0, 1};
  assert_true(latest.fresh(10.0, 0.25));
  assert_true(latest.fresh(10.25, 0.25));
  assert_false(latest.fresh(10.2501, 0.25));
  assert_false(latest.fresh(9.999, 0.25));
  assert_false(Latest<Target>().fresh(0.0, 0.25));
  check_near(latest.age_s(10.1), 0.1, 1e-12);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(possible_values_are_plausible),
      cmocka_unit_test(an_arm_state_with_an_impossible_number_is_rejected),
      cmocka_unit_test(an_arm_state_with_a_wrong_number_of_joints_is_rejected),
      cmocka_unit_test(a_target_with_an_impossible_number_is_rejected),
      cmocka_unit_test(an_orientation_that_is_no_unit_quaternion_is_rejected),
      cmocka_unit_test(an_obstacle_with_an_impossible_number_is_rejected),
      cmocka_unit_test(a_message_is_fresh_from_its_receipt_to_its_age_limit),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
