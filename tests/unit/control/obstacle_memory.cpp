#include "firmware/control/obstacle_memory.h"

#include <algorithm>
#include <memory>

#include "tests/support/allocation_count.h"
#include "tests/support/check.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::Random;

namespace {

constexpr double kSpeedBound_mps = 2.0, kMemory_s = 0.3, kPeriod_s = 0.01;

Obstacle ball(int32_t id, const Vector3& position_m) {
  return {id, Shape::kSphere, {position_m, position_m, 0.1}, Vector3::Zero(), Vector3::Zero()};
}

/// A memory and a sender of one set per period.
struct Scene {
  std::unique_ptr<ObstacleMemory> memory = std::make_unique<ObstacleMemory>(kSpeedBound_mps, kMemory_s);
  std::unique_ptr<ObstacleSet> set = std::make_unique<ObstacleSet>();
  double now_s = 0.0;

  /// Returns the number of remembered obstacles that were added to the set.
  int send(const std::vector<Obstacle>& obstacles, double elapsed_s = kPeriod_s) {
    now_s += elapsed_s;
    set->count = static_cast<int>(obstacles.size());
    std::copy(obstacles.begin(), obstacles.end(), set->obstacles.begin());
    memory->add_remembered(*set, elapsed_s, now_s);
    return set->count - static_cast<int>(obstacles.size());
  }
  const Obstacle& last() const { return set->obstacles[static_cast<size_t>(set->count - 1)]; }
};

void an_obstacle_that_jumps_also_counts_at_its_last_position_for_a_while(void**) {
  Scene scene;
  Obstacle wrong = ball(1, Vector3(0, 0, 1));  // position and velocity are both wrong
  wrong.velocity_mps = wrong.mean_velocity_mps = wrong.lead_mps = Vector3(100, 0, 0);
  assert_int_equal(scene.send({wrong, ball(2, Vector3(1, 0, 1))}), 0);
  int periods = 0;
  while (scene.send({ball(1, Vector3(0, 3, 1)), ball(2, Vector3(1, 0, 1))}) == 1 && ++periods < 1000) {
    assert_int_equal(scene.last().id, 1);
    check_near(scene.last().capsule.start, Vector3(0, 0, 1), 0);
    check_near(scene.last().velocity_mps, Vector3::Zero(), 0);
    check_near(scene.last().mean_velocity_mps, Vector3::Zero(), 0);
    check_near(scene.last().lead_mps, Vector3::Zero(), 0);
  }
  check_near((periods + 1) * kPeriod_s, kMemory_s, 1.01 * kPeriod_s);
}

void motion_within_the_speed_bound_is_no_jump(void**) {
  Scene scene;
  for (int i = 0; i < 200; ++i)
    assert_int_equal(scene.send({ball(1, Vector3(kSpeedBound_mps * kPeriod_s * i, 0, 0))}), 0);
  for (int i = 0; i < 20; ++i)  // after a gap an obstacle may be farther away
    assert_int_equal(scene.send({ball(1, Vector3(0, kSpeedBound_mps * 0.5 * i, 0))}, i == 0 ? 10.0 : 0.5), 0);
  Obstacle fast = ball(1, Vector3(0, 0, 0));
  fast.velocity_mps = Vector3(20, 0, 0);
  scene.send({fast}, 100.0);
  for (int i = 0; i < 20; ++i) {
    fast.capsule.start.x() = fast.capsule.end.x() += 20 * kPeriod_s;
    assert_int_equal(scene.send({fast}), 0);
  }
}

/// A capsule that turns by half a turn is unchanged; one that turns by a quarter has jumped.
void a_capsule_jumps_when_an_end_of_its_axis_does(void**) {
  const Vector3 a(-0.5, 0, 0), b(0.5, 0, 0), c(0, 0.5, 0), d(0, -0.5, 0);
  const auto capsule = [](const Vector3& start, const Vector3& end) {
    return Obstacle{1, Shape::kCapsule, {start, end, 0.05}, Vector3::Zero(), Vector3::Zero()};
  };
  Scene scene;
  scene.send({capsule(a, b)});
  assert_int_equal(scene.send({capsule(b, a)}), 0);
  assert_int_equal(scene.send({capsule(c, d)}), 1);
}

/// A slab that turns by a quarter has jumped; it is remembered as a box.
void a_box_jumps_when_it_turns_about_its_longest_edge(void**) {
  const Vector3 edges(1, 0.5, 0.05);
  const Obstacle standing = box_obstacle(Vector3::Zero(), Matrix3::Identity(), edges);
  const Matrix3 quarter = Eigen::AngleAxisd(M_PI / 2, Vector3::UnitX()).toRotationMatrix();
  Scene scene;
  scene.send({standing});
  assert_int_equal(scene.send({box_obstacle(Vector3::Zero(), quarter * quarter, edges)}), 0);
  assert_int_equal(scene.send({box_obstacle(Vector3::Zero(), quarter, edges)}), 1);
  check_near(scene.last().half_width_m.cwiseAbs().eval(), standing.half_width_m, 1e-12);
}

/// The old size moves on with the obstacle, also when the obstacle was not reported in between.
void an_obstacle_that_shrinks_also_counts_with_its_last_size_for_a_while(void**) {
  for (const bool vanishes : {false, true}) {
    Scene scene;
    Obstacle large = ball(1, Vector3(0, 0, 1));
    large.velocity_mps = Vector3(0.5, 0, 0);
    Obstacle small = large;
    small.capsule.radius_m = 0.001;
    scene.send({large});
    if (vanishes) scene.send({});
    int periods = vanishes ? 1 : 0;
    while (scene.send({small}) == 1 && ++periods < 1000) {
      check_near(scene.last().capsule.radius_m, 0.1, 0);
      check_near(scene.last().capsule.start, Vector3(0.5 * kPeriod_s * periods, 0, 1), 1e-12);
    }
    check_near((periods + 1) * kPeriod_s, kMemory_s, 1.01 * kPeriod_s);
  }
}

/// Every dimension counts; noise of 1 cm and growth do not.
void a_smaller_dimension_or_another_shape_is_a_shrink(void**) {
  const Matrix3 upright = Matrix3::Identity();
  const auto box = [&](double x, double y, double z) { return box_obstacle(Vector3::Zero(), upright, {x, y, z}); };
  const auto rod = [&](double radius, double length) {
    return capsule_obstacle(Vector3::Zero(), upright, radius, length);
  };
  const auto sphere = [](double radius) { return sphere_obstacle(Vector3::Zero(), radius); };
  const struct {
    Obstacle before, now;
    int remembered;
  } cases[] = {
      {sphere(0.08), sphere(0.071), 0},
      {sphere(0.08), sphere(0.069), 1},
      {sphere(0.08), sphere(0.5), 0},
      {rod(0.05, 0.3), rod(0.05, 0.29), 0},
      {rod(0.05, 0.3), rod(0.05, 0.27), 1},
      {rod(0.05, 0.3), rod(0.03, 0.3), 1},
      {box(0.4, 0.3, 0.2), box(0.39, 0.29, 0.19), 0},
      {box(0.4, 0.3, 0.2), box(0.37, 0.3, 0.2), 1},
      {box(0.4, 0.3, 0.2), box(0.4, 0.27, 0.2), 1},
      {box(0.4, 0.3, 0.2), box(0.4, 0.3, 0.17), 1},
      {box(0.4, 0.3, 0.2), box(0.42, 0.32, 0.22), 0},
      {rod(0.1, 0.01), sphere(0.1), 1},
  };
  for (const auto& each : cases) {
    Scene scene;
    scene.send({each.before});
    assert_int_equal(scene.send({each.now}), each.remembered);
    if (each.remembered == 1) check_near(scene.last().capsule.radius_m, each.before.capsule.radius_m, 0);
  }
}

/// A vanished obstacle may be hidden; its velocity is assumed constant.
void a_vanished_obstacle_counts_for_a_while_at_its_extrapolated_position(void**) {
  Scene scene;
  Obstacle moving = ball(1, Vector3(0, 0, 1));
  moving.velocity_mps = Vector3(0.5, 0, 0);
  scene.send({moving, ball(2, Vector3(1, 0, 1))});
  int periods = 0;
  while (scene.send({ball(2, Vector3(1, 0, 1))}) == 1 && ++periods < 1000) {
    assert_int_equal(scene.last().id, 1);
    check_near(scene.last().capsule.start, Vector3(0.5 * kPeriod_s * periods, 0, 1), 1e-12);
    check_near(scene.last().velocity_mps, moving.velocity_mps, 0);
  }
  check_near((periods + 1) * kPeriod_s, kMemory_s, 1.01 * kPeriod_s);
}

void an_obstacle_that_returns_is_not_remembered_and_does_not_jump(void**) {
  Scene scene;
  scene.send({ball(1, Vector3(0, 0, 0)), ball(7, Vector3(0, 0, 0))});
  assert_int_equal(scene.send({ball(7, Vector3(0, 0, 0))}), 1);
  assert_int_equal(scene.send({ball(7, Vector3(0, 0, 0)), ball(1, Vector3(5, 0, 0))}), 0);
}

/// Each sender reports only its own obstacles, few or many.
void the_obstacles_of_two_alternating_senders_all_count(void**) {
  Random random(3);
  for (const int count : {1, 10, 300}) {
    std::vector<Obstacle> one, other;
    for (int i = 0; i < count; ++i) one.push_back(ball(2 * i, random.inside(-2, 2)));
    for (int i = 0; i < 3; ++i) other.push_back(ball(2 * i + 1, random.inside(-2, 2)));
    Scene scene;
    scene.send(one);
    for (int turn = 0; turn < 100; ++turn) {
      assert_int_equal(scene.send(other), count);
      assert_int_equal(scene.send(one), 3);
    }
  }
}

/// The clock of one of two senders is behind. An obstacle that both report counts once.
void the_obstacles_of_a_sender_that_is_always_late_count(void**) {
  Scene scene;
  ObstacleSet late;
  late.count = 2;
  late.obstacles[0] = ball(2, Vector3(0, 1, 0));
  late.obstacles[1] = ball(5, Vector3(0, 0, 1));
  late.obstacles[0].velocity_mps = Vector3(0, 0.5, 0);
  for (int turn = 0; turn < 100; ++turn) {
    scene.now_s += 0.5 * kPeriod_s;
    scene.memory->add_late_set(late, 0.1, scene.now_s);
    assert_int_equal(scene.send({ball(1, Vector3(1, 0, 0)), ball(5, Vector3(0, 0, 1))}, 0.5 * kPeriod_s), 1);
    check_near(scene.last().capsule.start, Vector3(0, 1 + 0.5 * 0.5 * kPeriod_s, 0), 1e-12);
  }
  late.obstacles[1] = ball(5, Vector3(0, 0, 2));  // another obstacle with the same id
  scene.memory->add_late_set(late, 0.1, scene.now_s);
  assert_int_equal(scene.send({ball(1, Vector3(1, 0, 0)), ball(5, Vector3(0, 0, 1))}), 2);
  int periods = 0;
  while (scene.send({}) > 0 && ++periods < 1000) {
  }
  check_near(periods * kPeriod_s, kMemory_s, 2.01 * kPeriod_s);
}

void the_order_of_obstacles_in_a_message_does_not_matter(void**) {
  Random random(1);
  std::vector<Obstacle> obstacles;
  for (int i = 0; i < 100; ++i) obstacles.push_back(ball(i / 2, random.inside(-2, 2)));  // two with each id
  Scene scene;
  scene.send(obstacles);
  for (int i = 0; i < 20; ++i) {
    std::rotate(obstacles.begin(), obstacles.begin() + 2 * random.index(50), obstacles.end());
    assert_int_equal(scene.send(obstacles), 0);
  }
}

void a_clock_that_is_set_back_clears_the_memory(void**) {
  Scene scene;
  scene.now_s = 1000.0;
  scene.send({ball(1, Vector3(0, 0, 0))});
  assert_int_equal(scene.send({ball(1, Vector3(1, 0, 0))}), 1);
  scene.now_s = 5.0;
  assert_int_equal(scene.send({ball(1, Vector3(1, 0, 0))}), 0);
}

void a_full_set_of_jumping_obstacles_is_bounded_and_allocates_nothing(void**) {
  Random random(2);
  Scene scene;
  std::vector<Obstacle> obstacles;
  for (int i = 0; i < kMaxObstacles; ++i) obstacles.push_back(ball(random.index(5000), random.inside(-2, 2)));
  const int64_t before = test::allocation_count();
  for (int i = 0; i < 10; ++i) {
    for (Obstacle& obstacle : obstacles) obstacle = ball(obstacle.id, random.inside(-2, 2));
    assert_int_equal(scene.send(obstacles), 0);  // full
  }
  obstacles.resize(kMaxObstacles - 10);
  assert_int_equal(scene.send(obstacles), 10);
  assert_int_equal(scene.set->count, kMaxObstacles);
  obstacles.resize(1000);
  assert_int_equal(scene.send(obstacles), kMaxObstacles - 1000);
  assert_int_equal(scene.set->remembered, kMaxObstacles - 1000);
  assert_int_equal(test::allocation_count() - before, 0);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(an_obstacle_that_jumps_also_counts_at_its_last_position_for_a_while),
      cmocka_unit_test(motion_within_the_speed_bound_is_no_jump),
      cmocka_unit_test(a_capsule_jumps_when_an_end_of_its_axis_does),
      cmocka_unit_test(a_box_jumps_when_it_turns_about_its_longest_edge),
      cmocka_unit_test(an_obstacle_that_shrinks_also_counts_with_its_last_size_for_a_while),
      cmocka_unit_test(a_smaller_dimension_or_another_shape_is_a_shrink),
      cmocka_unit_test(a_vanished_obstacle_counts_for_a_while_at_its_extrapolated_position),
      cmocka_unit_test(an_obstacle_that_returns_is_not_remembered_and_does_not_jump),
      cmocka_unit_test(the_obstacles_of_two_alternating_senders_all_count),
      cmocka_unit_test(the_obstacles_of_a_sender_that_is_always_late_count),
      cmocka_unit_test(the_order_of_obstacles_in_a_message_does_not_matter),
      cmocka_unit_test(a_clock_that_is_set_back_clears_the_memory),
      cmocka_unit_test(a_full_set_of_jumping_obstacles_is_bounded_and_allocates_nothing),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
