#include "firmware/foresight/expectation.h"

#include <functional>
#include <memory>

#include "tests/support/check.h"
#include "tests/support/closed_loop.h"
#include "tests/support/lwa3.h"

using namespace sidestep;
using test::ClosedLoop;

namespace {

/// A tracking arm beside a sphere, a rollout of its present state, and what that rollout expects.
struct Scene {
  ClosedLoop loop = test::tracking("sidestep");
  Snapshot snapshot;
  Expectation expectation{loop.model.arm};

  explicit Scene(const Vector3& sphere_mps = Vector3(-0.1, 0.1, 0)) {
    loop.target.velocity_mps = Vector3(0.05, 0, 0);
    loop.add_sphere(Vector3(0.9, 0.2, 0.6), sphere_mps, 0.05);
    cycle();
    const auto rollout = std::make_unique<Rollout>(loop.model);
    expectation.set(snapshot, rollout->run(snapshot, Guide{}));
  }
  void cycle() {
    const Inputs inputs = loop.receive();
    const Result result = step(loop.model, loop.state, inputs, loop.now_s());
    loop.follow(result);
    take_snapshot(loop.model, inputs, loop.state, loop.now_s(), snapshot);
  }
  void run(double duration_s) {
    for (int i = 0; i < std::lround(duration_s * 100); ++i) cycle();
  }
};

void a_world_that_goes_on_as_before_is_as_expected_for_half_a_second_and_among_movers_for_a_fifth(void**) {
  for (const bool moves : {false, true}) {
    const auto scene = moves ? std::make_unique<Scene>() : std::make_unique<Scene>(Vector3::Zero());
    for (int cycle = 0; cycle < (moves ? 19 : 49); ++cycle) {
      check(scene->expectation.holds(scene->snapshot), "moves %d: not after %d cycles", moves, cycle);
      scene->cycle();
    }
    scene->run(0.05);
    check(!scene->expectation.holds(scene->snapshot), "moves %d", moves);
  }
}

/// Whether the snapshot is as expected 0.15 s after the rollout, if it is altered.
bool holds_after(const std::function<void(Snapshot&)>& alter) {
  const auto scene = std::make_unique<Scene>();
  scene->run(0.15);
  assert_true(scene->expectation.holds(scene->snapshot));
  alter(scene->snapshot);
  return scene->expectation.holds(scene->snapshot);
}

void an_obstacle_elsewhere_or_with_another_velocity_or_size_is_not_expected(void**) {
  const auto sphere = [](Snapshot& now) -> Obstacle& { return now.nearby.obstacles[0]; };
  assert_false(holds_after([&](Snapshot& now) { sphere(now).capsule.start.z() += 0.011; }));
  assert_false(holds_after([&](Snapshot& now) { sphere(now).capsule.end.z() -= 0.011; }));
  assert_false(holds_after([&](Snapshot& now) { sphere(now).velocity_mps.z() += 0.06; }));
  assert_false(holds_after([&](Snapshot& now) { sphere(now).capsule.radius_m += 0.011; }));
  assert_true(holds_after([&](Snapshot& now) { sphere(now).capsule.radius_m += 0.009; }));
}

void another_obstacle_or_one_less_is_not_expected(void**) {
  assert_false(holds_after([](Snapshot& now) { now.nearby.obstacles[now.nearby.count++] = now.nearby.obstacles[0]; }));
  assert_false(holds_after([](Snapshot& now) { --now.nearby.count; }));
  assert_false(holds_after([](Snapshot& now) { now.nearby.obstacles[0].id = 77; }));
}

void a_target_that_turns_or_jumps_is_not_expected(void**) {
  assert_false(holds_after([](Snapshot& now) { now.target.position_m.y() += 0.006; }));
  assert_false(holds_after([](Snapshot& now) { now.target.velocity_mps.y() += 0.03; }));
  assert_false(holds_after([](Snapshot& now) { now.target.tracks_orientation = true; }));
}

void a_posture_in_place_of_a_position_or_another_one_is_not_expected(void**) {
  assert_false(holds_after([](Snapshot& now) { now.target.posture_rad = now.arm.position_rad; }));
  const Arm& arm = test::lwa3();
  Target posture, other;
  posture.posture_rad = other.posture_rad = test::home_rad();
  assert_true(is_same_posture(posture, other, arm.joint_scale));
  other.posture_rad[6] += 0.0049;
  assert_true(is_same_posture(posture, other, arm.joint_scale));
  other.posture_rad[6] += 0.0002;
  assert_false(is_same_posture(posture, other, arm.joint_scale));
}

void an_arm_off_its_path_or_in_another_mode_is_not_expected(void**) {
  assert_false(holds_after([](Snapshot& now) { now.arm.position_rad[3] += 0.08; }));
  assert_false(holds_after([](Snapshot& now) { now.tracking = false; }));
}

void nothing_is_expected_before_a_forecast(void**) {
  const auto scene = std::make_unique<Scene>();
  scene->expectation.clear();
  assert_false(scene->expectation.holds(scene->snapshot));
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_world_that_goes_on_as_before_is_as_expected_for_half_a_second_and_among_movers_for_a_fifth),
      cmocka_unit_test(an_obstacle_elsewhere_or_with_another_velocity_or_size_is_not_expected),
      cmocka_unit_test(another_obstacle_or_one_less_is_not_expected),
      cmocka_unit_test(a_target_that_turns_or_jumps_is_not_expected),
      cmocka_unit_test(a_posture_in_place_of_a_position_or_another_one_is_not_expected),
      cmocka_unit_test(an_arm_off_its_path_or_in_another_mode_is_not_expected),
      cmocka_unit_test(nothing_is_expected_before_a_forecast),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
