#include <memory>

#include "firmware/io/lcm/link_encoder.h"
#include "firmware/io/lcm/obstacle_merger.h"
#include "firmware/model/link_obstacle.h"
#include "tests/support/allocation_count.h"
#include "tests/support/check.h"
#include "tests/support/lwa3.h"
#include "tests/support/messages.h"
#include "tests/support/random.h"
#include "tests/support/test_inputs.h"

using namespace sidestep;
using test::Bytes;
using test::encoded;
using test::lwa3;
using test::obstacles_message;
using test::sphere;

namespace {

Eigen::Isometry3d pose(const Vector3& position_m, double yaw_rad) {
  return Eigen::Translation3d(position_m) * Eigen::AngleAxisd(yaw_rad, Vector3::UnitZ());
}

Neighbours neighbours_at(const Eigen::Isometry3d& world_from_base, std::vector<std::string> listen) {
  return {"LINKS", std::move(listen), world_from_base};
}

Bytes ball_at(int64_t utime, const Vector3& centre_m, const Vector3& velocity_mps) {
  return encoded(obstacles_message(utime, {sphere(7, centre_m, 0.1, velocity_mps)}));
}

/// The inputs of one controller.
struct Subscriber {
  explicit Subscriber(const Neighbours& neighbours) : inputs(7, Settings(), kSidestepDialect, neighbours) {}

  /// Returns whether the message led to a merged set, which is then in `set` and `age_s`.
  bool receive(size_t part, const Bytes& bytes, double now_s) {
    const bool merged = inputs.receive_part(part, bytes.data(), bytes.size(), now_s, *set);
    if (merged) age_s = now_s - inputs.obstacles_received_s();
    return merged;
  }

  test::TestInputs inputs;
  std::unique_ptr<ObstacleSet> set = std::make_unique<ObstacleSet>();
  double age_s = 0.0;
};

void link_velocities_equal_finite_differences(void**) {
  test::Random random(1);
  const double dt_s = 1e-5;
  for (int trial = 0; trial < 20; ++trial) {
    const JointVector q_rad = random.joints(7, -2, 2), qd_radps = random.joints(7, -2, 2);
    const LinkPoses now = forward_kinematics(lwa3(), q_rad),
                    later = forward_kinematics(lwa3(), q_rad + dt_s * qd_radps);
    for (const LinkShape& shape : lwa3().shapes) {
      const Capsule predicted = extrapolated(link_obstacle(now, shape, qd_radps), dt_s).capsule;
      const Capsule there = transformed(later, shape);
      check_near(predicted.start, there.start, 1e-8);
      check_near(predicted.end, there.end, 1e-8);
    }
  }
}

void links_arrive_in_the_base_frame_of_the_receiver(void**) {
  const Neighbours sender = neighbours_at(pose({-0.5, 0.1, 0.2}, M_PI), {}),
                   receiver = neighbours_at(pose({0.5, 0, 0}, 0.7), {"LINKS"});
  const Eigen::Isometry3d there_from_here = receiver.world_from_base.inverse() * sender.world_from_base;
  test::Random random(2);
  const ArmState arm{1, random.joints(7, -2, 2), random.joints(7, -2, 2)};
  LinkEncoder links(lwa3(), sender.world_from_base);
  const Packet packet = links.encode(arm, lwa3().other_frames, 5);
  Subscriber subscriber(receiver);
  assert_false(subscriber.receive(1, Bytes(packet.bytes, packet.bytes + packet.size), 1.0));
  assert_true(subscriber.receive(0, ball_at(1, {1, 1, 1}, {0, 0, 0}), 1.0));
  const auto shapes = static_cast<int>(lwa3().shapes.size());
  assert_int_equal(subscriber.set->count, 1 + shapes);
  assert_int_equal(subscriber.set->obstacles[0].id, 7);
  const LinkPoses poses = forward_kinematics(lwa3(), arm.position_rad);
  for (int i = 0; i < shapes; ++i) {
    const LinkShape& shape = lwa3().shapes[static_cast<size_t>(i)];
    const Obstacle expected = transformed(there_from_here, link_obstacle(poses, shape, arm.velocity_radps));
    const Obstacle& received = subscriber.set->obstacles[static_cast<size_t>(1 + i)];
    assert_int_equal(received.id, -(10000 + i));
    check_near(received.capsule.start, expected.capsule.start, 1e-12);
    check_near(received.capsule.end, expected.capsule.end, 1e-12);
    check_near(received.capsule.radius_m, expected.capsule.radius_m, 0);
    check_near(received.velocity_mps, expected.velocity_mps, 1e-12);
    const bool turns = expected.capsule.start != expected.capsule.end;
    if (turns) check_near(received.angular_velocity_radps, expected.angular_velocity_radps, 1e-12);
  }
}

/// Merging enlarges no shape in any orientation.
void all_shapes_arrive_unchanged(void**) {
  Subscriber subscriber(neighbours_at(pose({0, 0, 0}, 0), {"LINKS"}));
  test::Random random(3);
  for (int trial = 1; trial <= 100; ++trial) {
    std::vector<obstacle_t> all(4);
    for (int8_t shape = 0; shape < 4; ++shape) {
      obstacle_t& each = all[static_cast<size_t>(shape)];
      each = sphere(shape, random.inside(-1, 1), 0, random.inside(-1, 1));
      each.shape = shape;
      each.kind = static_cast<int8_t>(trial % 2);
      const Quaternion turn = random.turn();
      const double wxyz[] = {turn.w(), turn.x(), turn.y(), turn.z()};
      std::copy(wxyz, wxyz + 4, each.quaternion);
      for (double& size : each.size) size = random.uniform(0.05, 0.8);
    }
    const Bytes bytes = encoded(obstacles_message(trial, all));
    const auto direct = std::make_unique<ObstacleSet>();
    test::TestInputs alone(7, Settings());
    assert_true(alone.receive(bytes.data(), bytes.size(), 0.01 * trial, *direct));
    subscriber.receive(1, encoded(obstacles_message(trial, {})), 0.01 * trial);
    assert_true(subscriber.receive(0, bytes, 0.01 * trial));
    for (size_t i = 0; i < 4; ++i) {
      const Obstacle &sent = direct->obstacles[i], &received = subscriber.set->obstacles[i];
      check_near(received.capsule.start, sent.capsule.start, 1e-12);
      check_near(received.capsule.end, sent.capsule.end, 1e-12);
      check_near(received.capsule.radius_m, sent.capsule.radius_m, 1e-12);
      check_near(received.half_width_m, sent.half_width_m, 1e-12);
      check_near(received.half_thickness_m, sent.half_thickness_m, 1e-12);
      assert_true(received.shape == static_cast<Shape>(i) && received.kind == sent.kind);
    }
  }
}

/// The ball moves at 1 m/s. The newer part is extrapolated back to the time of the oldest part.
void a_merged_set_is_as_old_as_its_oldest_part(void**) {
  Subscriber subscriber(neighbours_at(pose({0, 0, 0}, 0), {"LINKS"}));
  const Bytes neighbour = ball_at(1, {2, 0, 0}, {0, 0, 0});
  subscriber.receive(1, neighbour, 1.00);
  for (const double now_s : {1.02, 1.06, 1.09}) {
    check(subscriber.receive(0, ball_at(static_cast<int64_t>(now_s * 1e6), {now_s, 0, 0}, {1, 0, 0}), now_s), "%g s",
          now_s);
    check_near(subscriber.age_s, now_s - 1.00, 1e-9);
    check_near(subscriber.set->obstacles[0].capsule.start.x(), 1.00, 1e-9);
    check_near(subscriber.set->obstacles[1].capsule.start.x(), 2.00, 1e-9);
  }
  assert_false(
      subscriber.receive(0, ball_at(1110000, {1.11, 0, 0}, {1, 0, 0}), 1.11));  // the neighbour's part is too old
  assert_true(subscriber.receive(1, ball_at(2, {2, 0, 0}, {0, 0, 0}), 1.12));
  check_near(subscriber.age_s, 0.01, 1e-9);
  assert_int_equal(subscriber.inputs.rejected(), 0);
}

/// A ball at 1 m/s whose velocity nobody tells, at 100 Hz with jitter, beside a neighbour that sends seldom or often.
void the_motion_of_an_obstacle_is_estimated_whenever_the_neighbour_sends(void**) {
  test::Random random(4);
  for (const double neighbour_s : {0.01, 0.05}) {
    Subscriber subscriber(neighbours_at(pose({0, 0, 0}, 0), {"LINKS"}));
    double next_s = 0.001;
    for (int k = 0; k < 200; ++k) {
      const double sent_s = 0.01 * k, now_s = sent_s + random.uniform(0.001, 0.008);
      for (; next_s < now_s; next_s += neighbour_s)
        subscriber.receive(1, ball_at(std::lround(next_s * 1e6), {2, 0, 0}, {0, 0, 0}), next_s);
      if (!subscriber.receive(0, ball_at(std::lround(sent_s * 1e6), {sent_s, 0, 0}, {0, 0, 0}), now_s)) continue;
      if (k < 50) continue;
      const Obstacle& ball = subscriber.set->obstacles[0];
      check_near(ball.velocity_mps, Vector3(1, 0, 0), 0.05);
      check_near(extrapolated(ball, subscriber.age_s).capsule.start.x(), sent_s, 1e-3);
    }
  }
}

/// After a restart of the simulator, earlier messages of a neighbour no longer count.
void after_a_restart_of_the_clock_a_silent_neighbour_is_unknown(void**) {
  Subscriber subscriber(neighbours_at(pose({0, 0, 0}, 0), {"LINKS"}));
  assert_false(subscriber.receive(0, ball_at(1, {1, 0, 0}, {0, 0, 0}), 100.00));
  assert_true(subscriber.receive(1, ball_at(1, {2, 0, 0}, {1, 0, 0}), 100.01));
  for (const double now_s : {0.01, 0.02, 50.0, 100.0, 100.01, 100.02})
    assert_false(subscriber.receive(0, ball_at(static_cast<int64_t>(now_s * 1e6), {1, 0, 0}, {0, 0, 0}), now_s));
  assert_true(subscriber.receive(1, ball_at(2, {2, 0, 0}, {1, 0, 0}), 100.03));
}

void a_bad_message_of_one_neighbour_does_not_affect_the_others(void**) {
  Subscriber subscriber(neighbours_at(pose({0, 0, 0}, 0), {"LINKS", "MORE"}));
  subscriber.receive(1, ball_at(1, {2, 0, 0}, {0, 0, 0}), 1.0);
  subscriber.receive(2, ball_at(1, {3, 0, 0}, {0, 0, 0}), 1.0);
  assert_false(subscriber.receive(1, ball_at(2, {std::nan(""), 0, 0}, {0, 0, 0}), 1.01));
  assert_int_equal(subscriber.inputs.rejected(), 1);
  assert_string_equal(subscriber.inputs.last_reason(), "obstacles with impossible values");
  assert_true(subscriber.receive(0, ball_at(1, {1, 0, 0}, {0, 0, 0}), 1.02));
  assert_int_equal(subscriber.set->count, 3);
  for (int i = 0; i < 3; ++i)
    check_near(subscriber.set->obstacles[static_cast<size_t>(i)].capsule.start.x(), i + 1.0, 1e-12);
}

void more_obstacles_than_a_message_holds_are_not_merged(void**) {
  Subscriber subscriber(neighbours_at(pose({0, 0, 0}, 0), {"LINKS"}));
  const std::vector<obstacle_t> most(kMaxObstacles, sphere(1, {1, 1, 1}, 0.1, {0, 0, 0}));
  subscriber.receive(0, encoded(obstacles_message(1, most)), 1.0);
  assert_false(subscriber.receive(1, ball_at(1, {2, 0, 0}, {0, 0, 0}), 1.0));
  assert_int_equal(subscriber.inputs.rejected(), 1);
  assert_true(subscriber.receive(1, encoded(obstacles_message(2, {})), 1.0));
  assert_int_equal(subscriber.set->count, kMaxObstacles);
}

void encoding_and_merging_do_not_allocate(void**) {
  const Neighbours neighbours = neighbours_at(pose({0, 0, 0}, 0), {"LINKS"});
  LinkEncoder links(lwa3(), neighbours.world_from_base);
  Subscriber subscriber(neighbours);
  const ArmState arm{1, test::home_rad(), JointVector::Constant(7, 0.1)};
  const auto round = [&](int64_t utime) {
    const Bytes ball = ball_at(utime, {1, 1, 1}, {0, 0, 0});
    const int64_t before = test::allocation_count();
    const Packet sent = links.encode(arm, lwa3().other_frames, utime);
    subscriber.inputs.receive_part(0, ball.data(), ball.size(), 1.0, *subscriber.set);
    assert_true(subscriber.inputs.receive_part(1, sent.bytes, sent.size, 1.0, *subscriber.set));
    return test::allocation_count() - before;
  };
  round(1);
  assert_int_equal(round(2), 0);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(link_velocities_equal_finite_differences),
      cmocka_unit_test(links_arrive_in_the_base_frame_of_the_receiver),
      cmocka_unit_test(all_shapes_arrive_unchanged),
      cmocka_unit_test(a_merged_set_is_as_old_as_its_oldest_part),
      cmocka_unit_test(the_motion_of_an_obstacle_is_estimated_whenever_the_neighbour_sends),
      cmocka_unit_test(after_a_restart_of_the_clock_a_silent_neighbour_is_unknown),
      cmocka_unit_test(a_bad_message_of_one_neighbour_does_not_affect_the_others),
      cmocka_unit_test(more_obstacles_than_a_message_holds_are_not_merged),
      cmocka_unit_test(encoding_and_merging_do_not_allocate),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
