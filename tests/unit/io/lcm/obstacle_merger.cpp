#include <memory>

#include "firmware/io/lcm/admission.h"
#include "firmware/io/lcm/link_encoder.h"
#include "firmware/io/lcm/obstacle_merger.h"
#include "firmware/model/link_obstacle.h"
#include "tests/support/allocation_count.h"
#include "tests/support/check.h"
#include "tests/support/lwa3.h"
#include "tests/support/messages.h"
#include "tests/support/random.h"

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

Config config_at(const Eigen::Isometry3d& world_from_base, std::vector<std::string> listen) {
  Config config;
  config.model.arm = lwa3();
  config.neighbours = {"LINKS", std::move(listen), world_from_base};
  return config;
}

Bytes ball_at(int64_t utime, const Vector3& place_m, const Vector3& velocity_mps) {
  return encoded(obstacles_message(utime, {sphere(7, place_m, 0.1, velocity_mps)}));
}

/// Both ends of what a controller knows of its surroundings.
struct Listener {
  explicit Listener(const Config& config) : obstacle_merger(config), gate(7, config.model.settings) {}

  /// Whether a whole came of it, then in `set` and `age_s`.
  bool hear(size_t part, const Bytes& bytes, double now_s) {
    const auto whole = obstacle_merger.join(part, bytes.data(), bytes.size(), now_s);
    if (whole) age_s = whole->age_s;
    return whole && gate.admit(whole->packet.bytes, whole->packet.size, now_s - age_s, *set);
  }

  ObstacleMerger obstacle_merger;
  Admission gate;
  std::unique_ptr<ObstacleSet> set = std::make_unique<ObstacleSet>();
  double age_s = 0.0;
};

void links_move_as_finite_differences_say(void**) {
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

void links_arrive_in_the_base_frame_of_who_listens(void**) {
  const Config teller = config_at(pose({-0.5, 0.1, 0.2}, M_PI), {}),
               hearer = config_at(pose({0.5, 0, 0}, 0.7), {"LINKS"});
  const Eigen::Isometry3d there_from_here =
      hearer.neighbours.world_from_base.inverse() * teller.neighbours.world_from_base;
  test::Random random(2);
  const ArmState arm{1, random.joints(7, -2, 2), random.joints(7, -2, 2)};
  LinkEncoder links(teller);
  const Packet packet = links.encode(arm, 5);
  Listener listener(hearer);
  assert_false(listener.hear(1, Bytes(packet.bytes, packet.bytes + packet.size), 1.0));
  assert_true(listener.hear(0, ball_at(1, {1, 1, 1}, {0, 0, 0}), 1.0));
  const auto shapes = static_cast<int>(lwa3().shapes.size());
  assert_int_equal(listener.set->count, 1 + shapes);
  assert_int_equal(listener.set->obstacles[0].id, 7);
  const LinkPoses poses = forward_kinematics(lwa3(), arm.position_rad);
  for (int i = 0; i < shapes; ++i) {
    const LinkShape& shape = lwa3().shapes[static_cast<size_t>(i)];
    const Obstacle told = transformed(there_from_here, link_obstacle(poses, shape, arm.velocity_radps));
    const Obstacle& heard = listener.set->obstacles[static_cast<size_t>(1 + i)];
    assert_int_equal(heard.id, -(10000 + i));
    check_near(heard.capsule.start, told.capsule.start, 1e-12);
    check_near(heard.capsule.end, told.capsule.end, 1e-12);
    check_near(heard.capsule.radius_m, told.capsule.radius_m, 0);
    check_near(heard.velocity_mps, told.velocity_mps, 1e-12);
    const bool turns = told.capsule.start != told.capsule.end;
    if (turns) check_near(heard.angular_velocity_radps, told.angular_velocity_radps, 1e-12);
  }
}

/// However they lie and turn: none gets fatter on its way.
void all_shapes_arrive_as_they_are(void**) {
  Listener listener(config_at(pose({0, 0, 0}, 0), {"LINKS"}));
  test::Random random(3);
  for (int trial = 1; trial <= 100; ++trial) {
    std::vector<obstacle_t> all(3);
    for (int8_t shape = 0; shape < 3; ++shape) {
      obstacle_t& each = all[static_cast<size_t>(shape)];
      each = sphere(shape, random.inside(-1, 1), 0, random.inside(-1, 1));
      each.shape = shape;
      const Quaternion turn = random.turn();
      const double wxyz[] = {turn.w(), turn.x(), turn.y(), turn.z()};
      std::copy(wxyz, wxyz + 4, each.quaternion);
      for (double& size : each.size) size = random.uniform(0.05, 0.8);
    }
    const Bytes bytes = encoded(obstacles_message(trial, all));
    const auto as_it_is = std::make_unique<ObstacleSet>();
    Admission gate(7, config_at(pose({0, 0, 0}, 0), {}).model.settings);
    assert_true(gate.admit(bytes.data(), bytes.size(), 0.01 * trial, *as_it_is));
    listener.hear(1, encoded(obstacles_message(trial, {})), 0.01 * trial);
    assert_true(listener.hear(0, bytes, 0.01 * trial));
    for (size_t i = 0; i < 3; ++i) {
      const Obstacle &sent = as_it_is->obstacles[i], &heard = listener.set->obstacles[i];
      check_near(heard.capsule.start, sent.capsule.start, 1e-12);
      check_near(heard.capsule.end, sent.capsule.end, 1e-12);
      check_near(heard.capsule.radius_m, sent.capsule.radius_m, 1e-12);
      check_near(heard.half_width_m, sent.half_width_m, 1e-12);
      check_near(heard.half_height_m, sent.half_height_m, 1e-12);
    }
  }
}

/// The ball moves at 1 m/s: what is heard later is moved back, so that the whole is true at its own time.
void a_whole_is_as_old_as_its_oldest_part(void**) {
  Listener listener(config_at(pose({0, 0, 0}, 0), {"LINKS"}));
  const Bytes neighbour = ball_at(1, {2, 0, 0}, {0, 0, 0});
  listener.hear(1, neighbour, 1.00);
  for (const double now_s : {1.02, 1.06, 1.09}) {
    check(listener.hear(0, ball_at(static_cast<int64_t>(now_s * 1e6), {now_s, 0, 0}, {1, 0, 0}), now_s), "%g s", now_s);
    check_near(listener.age_s, now_s - 1.00, 1e-9);
    check_near(listener.set->obstacles[0].capsule.start.x(), 1.00, 1e-9);
    check_near(listener.set->obstacles[1].capsule.start.x(), 2.00, 1e-9);
  }
  assert_false(listener.hear(0, ball_at(1110000, {1.11, 0, 0}, {1, 0, 0}), 1.11));  // it has fallen silent
  assert_true(listener.hear(1, ball_at(2, {2, 0, 0}, {0, 0, 0}), 1.12));
  check_near(listener.age_s, 0.01, 1e-9);
  assert_int_equal(listener.obstacle_merger.rejected(), 0);
}

/// A simulator that begins again: what a neighbour said before counts no more.
void where_the_clock_starts_over_a_silent_neighbour_is_unknown(void**) {
  Listener listener(config_at(pose({0, 0, 0}, 0), {"LINKS"}));
  assert_false(listener.hear(0, ball_at(1, {1, 0, 0}, {0, 0, 0}), 100.00));
  assert_true(listener.hear(1, ball_at(1, {2, 0, 0}, {1, 0, 0}), 100.01));
  for (const double now_s : {0.01, 0.02, 50.0, 100.0, 100.01, 100.02})
    assert_false(listener.hear(0, ball_at(static_cast<int64_t>(now_s * 1e6), {1, 0, 0}, {0, 0, 0}), now_s));
  assert_true(listener.hear(1, ball_at(2, {2, 0, 0}, {1, 0, 0}), 100.03));
}

void a_bad_message_of_a_neighbour_leaves_the_others_alone(void**) {
  Listener listener(config_at(pose({0, 0, 0}, 0), {"LINKS", "MORE"}));
  listener.hear(1, ball_at(1, {2, 0, 0}, {0, 0, 0}), 1.0);
  listener.hear(2, ball_at(1, {3, 0, 0}, {0, 0, 0}), 1.0);
  assert_false(listener.hear(1, ball_at(2, {std::nan(""), 0, 0}, {0, 0, 0}), 1.01));
  assert_int_equal(listener.obstacle_merger.rejected(), 1);
  assert_string_equal(listener.obstacle_merger.last_reason(), "obstacles with impossible values");
  assert_true(listener.hear(0, ball_at(1, {1, 0, 0}, {0, 0, 0}), 1.02));
  assert_int_equal(listener.set->count, 3);
  for (int i = 0; i < 3; ++i)
    check_near(listener.set->obstacles[static_cast<size_t>(i)].capsule.start.x(), i + 1.0, 1e-12);
  assert_int_equal(listener.gate.rejected(), 0);
}

void more_obstacles_than_a_message_holds_are_no_whole(void**) {
  Listener listener(config_at(pose({0, 0, 0}, 0), {"LINKS"}));
  const std::vector<obstacle_t> most(kMaxObstacles, sphere(1, {1, 1, 1}, 0.1, {0, 0, 0}));
  listener.hear(0, encoded(obstacles_message(1, most)), 1.0);
  assert_false(listener.hear(1, ball_at(1, {2, 0, 0}, {0, 0, 0}), 1.0));
  assert_int_equal(listener.obstacle_merger.rejected(), 1);
  assert_true(listener.hear(1, encoded(obstacles_message(2, {})), 1.0));
  assert_int_equal(listener.set->count, kMaxObstacles);
}

void who_listens_to_nobody_takes_messages_as_they_are(void**) {
  ObstacleMerger alone(config_at(pose({0, 0, 0}, 0), {}));
  const uint8_t garbage[] = {1, 2, 3};
  for (const size_t size : {sizeof garbage, size_t{0}}) {
    const auto whole = alone.join(0, garbage, size, 1.0);
    assert_ptr_equal(whole.value().packet.bytes, garbage);
    assert_int_equal(whole.value().packet.size, size);
  }
}

void telling_and_hearing_do_not_allocate(void**) {
  const Config config = config_at(pose({0, 0, 0}, 0), {"LINKS"});
  LinkEncoder links(config);
  Listener listener(config);
  const ArmState arm{1, test::home_rad(), JointVector::Constant(7, 0.1)};
  const Bytes ball = ball_at(1, {1, 1, 1}, {0, 0, 0});
  ObstacleMerger& obstacle_merger = listener.obstacle_merger;
  const auto round = [&](int64_t utime) {
    const Packet told = links.encode(arm, utime);
    obstacle_merger.join(0, ball.data(), ball.size(), 1.0);
    return obstacle_merger.join(1, told.bytes, told.size, 1.0).has_value();
  };
  assert_true(round(1));
  const int64_t before = test::allocation_count();
  assert_true(round(2));
  assert_int_equal(test::allocation_count(), before);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(links_move_as_finite_differences_say),
      cmocka_unit_test(links_arrive_in_the_base_frame_of_who_listens),
      cmocka_unit_test(all_shapes_arrive_as_they_are),
      cmocka_unit_test(a_whole_is_as_old_as_its_oldest_part),
      cmocka_unit_test(where_the_clock_starts_over_a_silent_neighbour_is_unknown),
      cmocka_unit_test(a_bad_message_of_a_neighbour_leaves_the_others_alone),
      cmocka_unit_test(more_obstacles_than_a_message_holds_are_no_whole),
      cmocka_unit_test(who_listens_to_nobody_takes_messages_as_they_are),
      cmocka_unit_test(telling_and_hearing_do_not_allocate),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
