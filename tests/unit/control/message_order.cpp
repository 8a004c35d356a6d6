#include "firmware/control/message_order.h"

#include <functional>
#include <limits>
#include <vector>

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

void only_newer_messages_are_accepted(void**) {
  MessageOrder order;
  assert_true(order.accept(1000, 1.000, 0.1));
  assert_false(order.accept(1000, 1.001, 0.1));
  assert_false(order.accept(999, 1.002, 0.1));
  assert_false(MessageOrder(order).accept(1000, 2.000, 0.1));  // a frozen sender repeats its last message
  assert_true(order.accept(1001, 1.003, 0.1));
  assert_true(order.accept(900000000, 1.004, 0.1));
}

void the_first_message_is_accepted_with_any_utime(void**) {
  for (const int64_t utime : {INT64_MIN, int64_t{-1}, int64_t{0}, INT64_MAX}) {
    MessageOrder order;
    check(order.accept(utime, 0.0, 0.1), "%ld", utime);
  }
}

void a_restarted_sender_is_accepted(void**) {
  MessageOrder far_back;
  assert_true(far_back.accept(5'000'000, 1.00, 0.1));
  assert_false(far_back.accept(4'950'000, 1.01, 0.1));  // 50 ms back: late, not restarted
  assert_false(far_back.accept(10, 1.02, 0.1));         // 5 s back: restarted or very late
  assert_false(far_back.accept(20, 1.03, 0.1));
  assert_true(far_back.accept(30, 1.04, 0.1));  // three in a row: restarted
  assert_true(far_back.accept(40, 1.05, 0.1));
  assert_false(far_back.accept(35, 1.06, 0.1));

  MessageOrder silence;
  assert_true(silence.accept(5'000'000, 1.00, 0.1));
  assert_false(silence.accept(4'990'000, 1.09, 0.1));
  assert_true(silence.accept(4'990'000, 1.11, 0.1));
}

/// Any number of such messages between newer ones is dropped, too.
void a_message_that_is_very_late_is_dropped(void**) {
  MessageOrder order;
  for (int i = 0; i < 20; ++i) {
    assert_true(order.accept(5'000'000 + 10'000 * i, 1.00 + 0.01 * i, 0.1));
    assert_false(order.accept(4'000'000 + 10'000 * i, 1.001 + 0.01 * i, 0.1));
    assert_false(order.accept(3'000'000, 1.002 + 0.01 * i, 0.1));
  }
}

void one_message_from_the_far_future_does_not_lock_its_sender_out(void**) {
  MessageOrder order;
  assert_true(order.accept(1'000'000, 1.00, 0.1));
  assert_true(order.accept(INT64_MAX, 1.01, 0.1));
  assert_false(order.accept(1'020'000, 1.02, 0.1));
  assert_false(order.accept(1'030'000, 1.03, 0.1));
  assert_true(order.accept(1'040'000, 1.04, 0.1));
  assert_false(order.accept(INT64_MIN, 1.05, 0.1));
  assert_true(order.accept(1'060'000, 1.06, 0.1));
}

/// Without this bound a sender that stamps in nanoseconds would appear to send seconds apart.
void elapsed_time_follows_the_senders_clock_within_the_network_delay(void**) {
  MessageOrder order;
  assert_true(order.accept(1'000'000, 1.00, 0.1));
  check_near(order.elapsed_s(), 0.0, 0);
  assert_true(order.accept(1'020'000, 1.01, 0.1));
  check_near(order.elapsed_s(), 0.02, 1e-12);
  assert_true(order.accept(1'021'000, 1.05, 0.1));
  check_near(order.elapsed_s(), 0.04, 1e-12);
  assert_true(order.accept(11'021'000, 1.06, 0.1));
  check_near(order.elapsed_s(), 0.11, 1e-12);
}

/// In lockstep the arm's utime is also the controller's clock.
void old_messages_are_dropped_when_the_messages_are_the_clock(void**) {
  MessageOrder order;
  assert_true(order.accept(5'000'000, 5.00, 0.1));
  assert_true(order.accept(6'000'000, 6.00, 0.1));
  assert_false(order.accept(6'000'000, 6.00, 0.1));
  assert_false(order.accept(5'990'000, 5.99, 0.1));
  assert_true(order.accept(1'000'000, 1.00, 0.1));
  assert_true(order.accept(1'010'000, 1.01, 0.1));
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
      cmocka_unit_test(only_newer_messages_are_accepted),
      cmocka_unit_test(the_first_message_is_accepted_with_any_utime),
      cmocka_unit_test(a_restarted_sender_is_accepted),
      cmocka_unit_test(a_message_that_is_very_late_is_dropped),
      cmocka_unit_test(one_message_from_the_far_future_does_not_lock_its_sender_out),
      cmocka_unit_test(elapsed_time_follows_the_senders_clock_within_the_network_delay),
      cmocka_unit_test(old_messages_are_dropped_when_the_messages_are_the_clock),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
