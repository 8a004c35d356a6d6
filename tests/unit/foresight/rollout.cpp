#include "firmware/foresight/rollout.h"

#include <memory>

#include "tests/support/allocation_count.h"
#include "tests/support/check.h"
#include "tests/support/closed_loop.h"
#include "tests/support/lwa3.h"

using namespace sidestep;
using test::ClosedLoop;

namespace {

/// A snapshot of a closed loop after one more cycle.
std::unique_ptr<Snapshot> snapshot_of(ClosedLoop& loop) {
  const Inputs inputs = loop.receive();
  const Result result = step(loop.model, loop.state, inputs, loop.now_s());
  loop.follow(result);
  auto snapshot = std::make_unique<Snapshot>();
  take_snapshot(loop.model, inputs, loop.state, loop.now_s(), *snapshot);
  return snapshot;
}

Forecast forecast_of(ClosedLoop& loop) {
  const auto rollout = std::make_unique<Rollout>(loop.model);
  return rollout->run(*snapshot_of(loop), Guide{});
}

void a_snapshot_is_tracking_only_in_that_mode(void**) {
  ClosedLoop loop = test::at_home("sidestep");
  assert_false(snapshot_of(loop)->tracking);
  ClosedLoop moving = test::tracking("sidestep");
  assert_true(snapshot_of(moving)->tracking);
}

/// Every other one of 100 spheres is out of reach; those are dropped first.
void of_too_many_obstacles_a_snapshot_keeps_the_nearest_to_the_base(void**) {
  ClosedLoop loop = test::tracking("sidestep");
  for (int i = 0; i < 50; ++i) {
    loop.add_sphere(Vector3(3.0 + 0.1 * i, 0, 0), Vector3::Zero(), 0.05);
    loop.add_sphere(Vector3(0, 1.5 + 0.01 * i, 0), Vector3::Zero(), 0.05);
  }
  const auto snapshot = snapshot_of(loop);
  assert_int_equal(snapshot->nearby.count, kMaxNearbyObstacles);
  int near = 0;
  double farthest_m = 0.0;
  for (int i = 0; i < snapshot->nearby.count; ++i) {
    const Vector3 centre = snapshot->nearby.obstacles[static_cast<size_t>(i)].capsule.centre();
    near += centre.norm() < 2.5;
    farthest_m = std::max(farthest_m, centre.norm());
  }
  assert_int_equal(near, 50);
  check_near(farthest_m, 3.0 + 0.1 * 13, 1e-9);
}

void a_target_keeps_its_velocity_for_a_second_and_then_rests(void**) {
  Target target;
  target.position_m = Vector3(1, 2, 3);
  target.velocity_mps = Vector3(0.1, 0, 0);
  check_near(predicted_target(target, 0.5).position_m, Vector3(1.05, 2, 3), 1e-12);
  check_near(predicted_target(target, 0.5).velocity_mps, target.velocity_mps, 0.0);
  for (const double after_s : {1.0, 4.0}) {
    check_near(predicted_target(target, after_s).position_m, Vector3(1.1, 2, 3), 1e-12);
    check_near(predicted_target(target, after_s).velocity_mps, Vector3(0, 0, 0), 0.0);
  }
}

void the_tool_is_at_the_target_within_10_mm_and_a_twentieth_of_a_radian(void**) {
  const LinkPoses poses = forward_kinematics(test::lwa3(), test::home_rad());
  Target target;
  target.position_m = poses.tool_position + Vector3(0, 0.0099, 0);
  target.orientation = Quaternion(Eigen::AngleAxisd(0.06, Vector3::UnitX())) * Quaternion(poses.tool_rotation);
  assert_true(is_at(poses, target));
  target.tracks_orientation = true;
  assert_false(is_at(poses, target));
  target.orientation = Quaternion(Eigen::AngleAxisd(0.04, Vector3::UnitX())) * Quaternion(poses.tool_rotation);
  assert_true(is_at(poses, target));
  target.position_m.y() += 0.0002;
  assert_false(is_at(poses, target));
}

void a_rollout_with_a_clear_path_arrives_at_the_cost_of_the_time_it_takes(void**) {
  ClosedLoop loop = test::tracking("sidestep");
  const Forecast forecast = forecast_of(loop);
  assert_true(forecast.arrives);
  assert_false(forecast.collides);
  double arrival_s = 0.0;
  while (!is_at(forward_kinematics(loop.model.arm, loop.arm.position_rad), loop.target) && arrival_s < 6.0) {
    loop.cycle();
    arrival_s += loop.model.settings.period_s();
  }
  check(std::abs(forecast.cost_s - arrival_s) < 0.15, "%g s, and %g s in the loop", forecast.cost_s, arrival_s);
}

void a_rollout_to_a_target_inside_an_obstacle_does_not_arrive(void**) {
  ClosedLoop loop = test::tracking("sidestep");
  loop.target.position_m += Vector3(0.3, 0, 0);
  loop.add_sphere(loop.target.position_m, Vector3::Zero(), 0.1);
  const Forecast forecast = forecast_of(loop);
  assert_false(forecast.arrives);
  assert_false(forecast.collides);
  check(forecast.cost_s > loop.model.settings.foresight.horizon_s, "cost %g s", forecast.cost_s);
}

void a_rollout_meets_an_obstacle_that_comes_too_fast(void**) {
  ClosedLoop loop = test::tracking("sidestep");
  loop.add_sphere(Vector3(0, 3.0, 0.6), Vector3(0, -1.9, 0), 0.5);
  const Forecast forecast = forecast_of(loop);
  assert_true(forecast.collides);
  check(forecast.cost_s >= 20.0, "cost %g s", forecast.cost_s);
}

void the_same_snapshot_gives_the_same_forecast_without_allocation(void**) {
  ClosedLoop loop = test::tracking("sidestep");
  loop.add_sphere(Vector3(0.2, 0.2, 0.6), Vector3(-0.1, -0.1, 0), 0.05);
  const auto snapshot = snapshot_of(loop);
  const auto rollout = std::make_unique<Rollout>(loop.model);
  const Forecast first = rollout->run(*snapshot, Guide{});
  const int64_t before = test::allocation_count();
  const Forecast second = rollout->run(*snapshot, Guide{});
  assert_int_equal(test::allocation_count() - before, 0);
  assert_int_equal(first.arrives, second.arrives);
  assert_int_equal(first.collides, second.collides);
  check_near(first.cost_s, second.cost_s, 0.0);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_snapshot_is_tracking_only_in_that_mode),
      cmocka_unit_test(of_too_many_obstacles_a_snapshot_keeps_the_nearest_to_the_base),
      cmocka_unit_test(a_target_keeps_its_velocity_for_a_second_and_then_rests),
      cmocka_unit_test(the_tool_is_at_the_target_within_10_mm_and_a_twentieth_of_a_radian),
      cmocka_unit_test(a_rollout_with_a_clear_path_arrives_at_the_cost_of_the_time_it_takes),
      cmocka_unit_test(a_rollout_to_a_target_inside_an_obstacle_does_not_arrive),
      cmocka_unit_test(a_rollout_meets_an_obstacle_that_comes_too_fast),
      cmocka_unit_test(the_same_snapshot_gives_the_same_forecast_without_allocation),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
