#include "firmware/io/lcm/network_inputs.h"

#include "firmware/model/nearest_points.h"
#include "tests/support/allocation_count.h"
#include "tests/support/check.h"
#include "tests/support/messages.h"
#include "tests/support/random.h"
#include "tests/support/test_inputs.h"

using namespace sidestep;
using test::arm_state_message;
using test::Bytes;
using test::encoded;
using test::obstacles_message;
using test::Random;
using test::target_message;
using test::TestInputs;

namespace {

constexpr int kJoints = 7;

template <typename Value>
bool receive(TestInputs& inputs, const Bytes& bytes, Value& value, double now_s = 0.0) {
  return inputs.receive(bytes.data(), bytes.size(), now_s, value);
}

obstacle_t random_obstacle(Random& random, int8_t shape) {
  obstacle_t message =
      test::sphere(random.index(1000) - 500, random.inside(-2, 2), random.uniform(0.01, 0.5), random.inside(-1, 1));
  message.shape = shape;
  const Quaternion turn = random.turn();
  const double wxyz[] = {turn.w(), turn.x(), turn.y(), turn.z()};
  std::copy(wxyz, wxyz + 4, message.quaternion);
  message.size[1] = random.uniform(0, 1);
  message.size[2] = random.uniform(0, 1);
  test::copy(random.inside(-2, 2), message.angular_velocity);
  return message;
}

Vector3 vector(const double* xyz) {
  return Vector3(xyz[0], xyz[1], xyz[2]);
}

Matrix3 rotation(const double* wxyz) {
  return Quaternion(wxyz[0], wxyz[1], wxyz[2], wxyz[3]).toRotationMatrix();
}

void an_arm_state_arrives_as_it_was_sent(void**) {
  Random random(1);
  for (int joints = 6; joints <= kMaxJoints; ++joints) {
    TestInputs inputs(joints, Settings());
    const JointVector q_rad = random.joints(joints, -3, 3), qd_radps = random.joints(joints, -2, 2);
    ArmState state;
    assert_true(receive(inputs, encoded(arm_state_message(123456789, q_rad, qd_radps)), state));
    assert_int_equal(state.utime, 123456789);
    check_near(state.position_rad, q_rad, 0);
    check_near(state.velocity_radps, qd_radps, 0);
    assert_int_equal(inputs.rejected(), 0);
    assert_string_equal(inputs.last_reason(), "");
  }
}

void a_target_arrives_as_it_was_sent(void**) {
  Random random(2);
  TestInputs inputs(kJoints, Settings());
  target_t message = target_message(5, random.inside(-1, 1), random.inside(-1, 1));
  message.tracks_orientation = 1;
  const double wxyz[] = {0.5, -0.5, 0.5, 0.5};
  std::copy(wxyz, wxyz + 4, message.quaternion);
  test::copy(Vector3(0.1, 0.2, 0.3), message.angular_velocity);
  Target target;
  assert_true(receive(inputs, encoded(message), target));
  assert_int_equal(target.utime, 5);
  check_near(target.position_m, vector(message.position), 0);
  check_near(target.velocity_mps, vector(message.velocity), 0);
  assert_true(target.tracks_orientation);
  check_near(target.orientation.toRotationMatrix(), rotation(wxyz), 1e-15);
  check_near(target.angular_velocity_radps, Vector3(0.1, 0.2, 0.3), 0);
}

void a_point_target_ignores_the_orientation_fields(void**) {
  TestInputs inputs(kJoints, Settings());
  target_t message = target_message(5, Vector3(1, 2, 3), Vector3(0, 0, 0));
  message.quaternion[0] = 0.0;
  message.angular_velocity[1] = 1e300;
  Target target;
  assert_true(receive(inputs, encoded(message), target));
  assert_false(target.tracks_orientation);
  check_near(target.orientation.coeffs(), Quaternion::Identity().coeffs(), 0);
  check_near(target.angular_velocity_radps, Vector3(0, 0, 0), 0);
}

void a_quaternion_of_nearly_unit_length_is_normalized(void**) {
  TestInputs inputs(kJoints, Settings());
  target_t message = target_message(5, Vector3(1, 2, 3), Vector3(0, 0, 0));
  message.tracks_orientation = 1;
  message.quaternion[0] = 1.0005;
  Target target;
  assert_true(receive(inputs, encoded(message), target));
  check_near(target.orientation.norm(), 1.0, 1e-15);
}

void spheres_and_capsules_arrive_as_they_were_sent(void**) {
  Random random(3);
  const auto set = std::make_unique<ObstacleSet>();
  TestInputs inputs(kJoints, Settings());
  for (int trial = 1; trial <= 100; ++trial) {
    const obstacle_t sphere = random_obstacle(random, obstacle_t::SPHERE),
                     capsule = random_obstacle(random, obstacle_t::CAPSULE);
    assert_true(receive(inputs, encoded(obstacles_message(trial, {sphere, capsule})), *set));
    assert_int_equal(set->count - set->remembered, 2);
    const Obstacle &a = set->obstacles[0], &b = set->obstacles[1];
    assert_int_equal(a.id, sphere.id);
    check_near(a.capsule.start, vector(sphere.position), 0);
    check_near(a.capsule.end, vector(sphere.position), 0);
    check_near(a.capsule.radius_m, sphere.size[0], 0);
    check_near(a.velocity_mps, vector(sphere.velocity), 0);
    assert_int_equal(b.id, capsule.id);
    const Vector3 half = rotation(capsule.quaternion) * Vector3(0, 0, capsule.size[1] / 2);
    check_near(b.capsule.start, vector(capsule.position) - half, 1e-12);
    check_near(b.capsule.end, vector(capsule.position) + half, 1e-12);
    check_near(b.capsule.radius_m, capsule.size[0], 0);
    check_near(b.velocity_mps, vector(capsule.velocity), 0);
    check_near(b.angular_velocity_radps, vector(capsule.angular_velocity), 0);
  }
}

void a_box_arrives_with_its_corners_and_a_capsule_that_encloses_them(void**) {
  Random random(4);
  const auto set = std::make_unique<ObstacleSet>();
  TestInputs inputs(kJoints, Settings());
  for (int trial = 1; trial <= 200; ++trial) {
    const obstacle_t sent = random_obstacle(random, obstacle_t::BOX);
    assert_true(receive(inputs, encoded(obstacles_message(trial, {sent})), *set));
    const Obstacle& obstacle = set->obstacles[0];
    assert_true(obstacle.shape == Shape::kBox);
    const Box box = box_of(obstacle);
    double farthest_m = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
      const Vector3 sign(corner & 1 ? 0.5 : -0.5, corner & 2 ? 0.5 : -0.5, corner & 4 ? 0.5 : -0.5);
      const Vector3 p = vector(sent.position) + rotation(sent.quaternion) * sign.cwiseProduct(vector(sent.size));
      const Vector3 in_box = (box.axes.transpose() * (p - box.centre)).cwiseAbs();
      check_near_because(in_box, box.half_m, 1e-12, "trial %d", trial);
      const Vector3 on_axis = nearest_on_segment(obstacle.capsule.start, obstacle.capsule.end, p);
      farthest_m = std::max(farthest_m, (p - on_axis).norm());
    }
    check_near_because(farthest_m, obstacle.capsule.radius_m, 1e-9, "trial %d", trial);
    check_near(obstacle.angular_velocity_radps, vector(sent.angular_velocity), 0);
  }
}

void an_empty_set_is_accepted(void**) {
  const auto set = std::make_unique<ObstacleSet>();
  set->count = 3;
  TestInputs inputs(kJoints, Settings());
  assert_true(receive(inputs, encoded(obstacles_message(1, {})), *set));
  assert_int_equal(set->count, 0);
}

void a_set_of_4096_obstacles_is_accepted_and_a_larger_one_rejected(void**) {
  const auto set = std::make_unique<ObstacleSet>();
  TestInputs inputs(kJoints, Settings());
  std::vector<obstacle_t> obstacles(kMaxObstacles, test::sphere(1, Vector3(1, 2, 3), 0.1, Vector3(0, 0, 0)));
  obstacles.back().id = 77;
  assert_int_equal(kMaxObstacles, 4096);
  assert_true(receive(inputs, encoded(obstacles_message(1, obstacles)), *set));
  assert_int_equal(set->count, 4096);
  assert_int_equal(set->obstacles[4095].id, 77);
  obstacles.push_back(obstacles.back());
  assert_false(receive(inputs, encoded(obstacles_message(2, obstacles)), *set));
  assert_int_equal(inputs.rejected(), 1);
}

/// Each channel has its own order.
void old_messages_are_dropped_but_not_counted_as_rejected(void**) {
  const auto set = std::make_unique<ObstacleSet>();
  TestInputs inputs(kJoints, Settings());
  ArmState arm;
  Target target;
  const JointVector zero = JointVector::Zero(kJoints);
  assert_true(receive(inputs, encoded(arm_state_message(2000, zero, zero)), arm, 1.00));
  assert_true(receive(inputs, encoded(target_message(1000, Vector3(0, 0, 1), Vector3(0, 0, 0))), target, 1.00));
  assert_true(receive(inputs, encoded(obstacles_message(1500, {})), *set, 1.00));
  assert_false(receive(inputs, encoded(arm_state_message(2000, zero, zero)), arm, 1.01));
  assert_false(receive(inputs, encoded(target_message(999, Vector3(0, 0, 1), Vector3(0, 0, 0))), target, 1.01));
  assert_false(receive(inputs, encoded(obstacles_message(1500, {})), *set, 1.01));
  assert_true(receive(inputs, encoded(target_message(1001, Vector3(0, 0, 1), Vector3(0, 0, 0))), target, 1.02));
  assert_int_equal(inputs.rejected(), 0);
  assert_string_equal(inputs.last_reason(), "");
}

/// Two balls that move, each reported by a sender of its own, without velocities. The clock of the second is behind by
/// so little that some of its sets are late, or by more.
void the_obstacles_of_two_senders_get_velocities(void**) {
  for (const double behind_s : {0.0, 0.005, 0.02, 5.0}) {
    TestInputs inputs(kJoints, Settings());
    const auto set = std::make_unique<ObstacleSet>();
    double found_mps = 0.0;
    for (int k = 0; k < 60; ++k) {
      const double first_s = 10.0 + k / 30.0, second_s = first_s + 0.01;
      const auto ball = [](int32_t id, double at_s, double clock_s) {
        return encoded(obstacles_message(std::lround(clock_s * 1e6),
                                         {test::sphere(id, {at_s - 10.0, 1.0 * id, 0}, 0.05, Vector3::Zero())}));
      };
      assert_true(receive(inputs, ball(1, first_s, first_s), *set, first_s));
      for (int i = 0; i < set->count; ++i)
        if (set->obstacles[static_cast<size_t>(i)].id == 2)
          found_mps = set->obstacles[static_cast<size_t>(i)].velocity_mps.x();
      receive(inputs, ball(2, second_s, second_s - behind_s), *set, second_s);
    }
    check(std::abs(found_mps - 1.0) < 0.1, "%g s behind: %g m/s", behind_s, found_mps);
  }
}

/// Each sender reports only its own obstacles as the full set; the clock of one is behind.
void the_obstacles_of_two_senders_all_count(void**) {
  for (const int64_t behind_us : {0, 15'000, 400'000}) {
    const auto set = std::make_unique<ObstacleSet>();
    TestInputs inputs(kJoints, Settings());
    const obstacle_t one = test::sphere(1, Vector3(1, 0, 0), 0.1, Vector3(0, 0, 0)),
                     other = test::sphere(2, Vector3(0, 1, 0), 0.1, Vector3(0, 0, 0));
    int accepted = 0;
    for (int turn = 0; turn < 100; ++turn) {
      const double now_s = 1.0 + 0.02 * turn;
      const auto utime = static_cast<int64_t>(now_s * 1e6);
      const auto send = [&](int64_t at_us, const obstacle_t& obstacle, double at_s) {
        if (!receive(inputs, encoded(obstacles_message(at_us, {obstacle})), *set, at_s)) return;
        ++accepted;
        check(turn == 0 || set->count == 2, "%ld us behind, turn %d: %d obstacles", behind_us, turn, set->count);
      };
      send(utime, one, now_s);
      send(utime + 10'000 - behind_us, other, now_s + 0.01);
    }
    check(accepted >= 100, "%d accepted", accepted);
    assert_int_equal(inputs.rejected(), 0);
  }
}

void no_message_allocates_after_the_first_of_its_kind(void**) {
  const auto set = std::make_unique<ObstacleSet>();
  TestInputs inputs(kJoints, Settings());
  ArmState arm;
  Target target;
  const JointVector zero = JointVector::Zero(kJoints);
  const std::vector<obstacle_t> many(kMaxObstacles, test::sphere(1, Vector3(1, 2, 3), 0.1, Vector3(0, 0, 0)));
  Bytes arms[3], targets[3], sets[3];
  for (int i = 0; i < 3; ++i) {
    arms[i] = encoded(arm_state_message(i, zero, zero));
    targets[i] = encoded(target_message(i, Vector3(0, 0, 1), Vector3(0, 0, 0)));
    sets[i] = encoded(obstacles_message(i, many));
  }
  for (int i = 0; i < 3; ++i) {
    const int64_t before = test::allocation_count();
    const bool good =
        receive(inputs, arms[i], arm) && receive(inputs, targets[i], target) && receive(inputs, sets[i], *set);
    Bytes& broken = sets[i];
    broken[30] ^= 0xff;
    broken[19] ^= 1;
    inputs.receive(broken.data(), broken.size(), 0.0, *set);
    const int64_t allocations = test::allocation_count() - before;
    assert_true(good);
    if (i > 0) check(allocations == 0, "%ld allocations in round %d", allocations, i);
  }
  const int64_t before = test::allocation_count();
  int* volatile one = new int(1);
  delete one;
  assert_true(test::allocation_count() > before);  // the counter works
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(an_arm_state_arrives_as_it_was_sent),
      cmocka_unit_test(a_target_arrives_as_it_was_sent),
      cmocka_unit_test(a_point_target_ignores_the_orientation_fields),
      cmocka_unit_test(a_quaternion_of_nearly_unit_length_is_normalized),
      cmocka_unit_test(spheres_and_capsules_arrive_as_they_were_sent),
      cmocka_unit_test(a_box_arrives_with_its_corners_and_a_capsule_that_encloses_them),
      cmocka_unit_test(an_empty_set_is_accepted),
      cmocka_unit_test(a_set_of_4096_obstacles_is_accepted_and_a_larger_one_rejected),
      cmocka_unit_test(old_messages_are_dropped_but_not_counted_as_rejected),
      cmocka_unit_test(the_obstacles_of_two_senders_all_count),
      cmocka_unit_test(the_obstacles_of_two_senders_get_velocities),
      cmocka_unit_test(no_message_allocates_after_the_first_of_its_kind),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
