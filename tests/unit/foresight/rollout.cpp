#include "firmware/foresight/rollout.h"

#include <cmath>
#include <memory>

#include "firmware/foresight/person_proximity.h"
#include "firmware/model/prediction.h"
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

/// 100 spheres that come nowhere near the arm, before and after the one that does.
void of_too_many_obstacles_a_snapshot_keeps_those_that_come_nearest_to_the_arm(void**) {
  ClosedLoop loop = test::tracking("sidestep");
  const Vector3 tool_m = loop.target.position_m;
  for (int i = 0; i < 50; ++i) loop.add_sphere(Vector3(-0.5, 0.01 * i, -0.6), Vector3::Zero(), 0.01);
  loop.add_sphere(tool_m + Vector3(0, 0, 2.0), Vector3(0, 0, -0.4), 0.05);
  for (int i = 0; i < 50; ++i) loop.add_sphere(Vector3(0.5, 0.01 * i, -0.6), Vector3::Zero(), 0.01);
  const auto snapshot = snapshot_of(loop);
  assert_int_equal(snapshot->nearby.count, kMaxNearbyObstacles);
  int falling = 0;
  for (int i = 0; i < snapshot->nearby.count; ++i)
    falling += snapshot->nearby.obstacles[static_cast<size_t>(i)].velocity_mps.z() < 0.0;
  assert_int_equal(falling, 1);
}

void a_snapshot_keeps_the_nearest_obstacles_at_rest(void**) {
  ClosedLoop loop = test::tracking("sidestep");
  for (int i = 0; i < 100; ++i) loop.add_sphere(Vector3(0, 1.5 + 0.01 * ((37 * i) % 100), 0), Vector3::Zero(), 0.05);
  const auto snapshot = snapshot_of(loop);
  double farthest_m = 0.0;
  for (int i = 0; i < snapshot->nearby.count; ++i)
    farthest_m = std::max(farthest_m, snapshot->nearby.obstacles[static_cast<size_t>(i)].capsule.start.y());
  check_near(farthest_m, 1.5 + 0.01 * 63, 1e-9);
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

/// Only the tool's orientation is missing; it costs half of the time that the turn takes.
void at_a_pose_at_rest_an_arm_that_turns_in_place_costs_half(void**) {
  ClosedLoop loop = test::at_home("sidestep");
  const LinkPoses poses = forward_kinematics(loop.model.arm, loop.arm.position_rad);
  loop.target.position_m = poses.tool_position;
  loop.target.orientation = Quaternion(poses.tool_rotation);
  loop.target.tracks_orientation = true;
  loop.sends_target = true;
  loop.run(2.0);
  loop.target.orientation = Quaternion(Eigen::AngleAxisd(1.0, Vector3::UnitZ())) * loop.target.orientation;
  const Forecast forecast = forecast_of(loop);
  assert_true(forecast.arrives);
  double turn_s = 0.0;
  while (!is_at(forward_kinematics(loop.model.arm, loop.arm.position_rad), loop.target) && turn_s < 6.0) {
    loop.cycle();
    turn_s += loop.model.settings.period_s();
  }
  assert_true(turn_s > 0.4);
  check(forecast.cost_s > 0.4 * turn_s && forecast.cost_s < 0.7 * turn_s, "%g s, and %g s in the loop", forecast.cost_s,
        turn_s);
}

/// With spheres that cross the arm's way and make it evade. At another period than the controller's a forecast is 1e-3
/// rad off after 0.1 s, and soon takes another side.
void the_near_future_is_forecast_as_it_comes(void**) {
  ClosedLoop loop = test::tracking("sidestep");
  for (const double side : {-1.0, 1.0})
    loop.add_sphere(loop.target.position_m + Vector3(0.3 * side, 0.2, 0), Vector3(-0.4 * side, -0.25, 0), 0.06);
  const Forecast forecast = forecast_of(loop);
  check_near(forecast.period_s, loop.model.settings.period_s(), 1e-12);
  check(forecast.path_rad.size() >= 49, "%d points", forecast.path_rad.size());
  for (int i = 0; i < forecast.path_rad.size(); ++i) {
    loop.cycle();
    check_near_because(forecast.path_rad[i], loop.arm.position_rad, 1e-6, "after %d cycles", i + 1);
  }
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

/// One that is still 2.4 m away when it is assumed to stop.
void a_rollout_does_not_meet_a_person_who_is_far_away(void**) {
  ClosedLoop loop = test::tracking("sidestep");
  loop.add_sphere(Vector3(0, 3.0, 0.6), Vector3(0, -1.9, 0), 0.5).kind = Kind::kPerson;
  assert_false(forecast_of(loop).collides);
}

/// Of an arm at its target, which it keeps.
void in_track_the_nearness_of_persons_costs_unless_their_separation_is_off(void**) {
  for (const Kind kind : {Kind::kThing, Kind::kPerson}) {
    for (const double weight : {0.0, 1e-3}) {
      for (const bool tracks : {false, true}) {
        ClosedLoop loop = test::at_home("sidestep");
        loop.model.settings.shield.person_weight = weight;
        loop.target.position_m = forward_kinematics(loop.model.arm, loop.arm.position_rad).tool_position;
        loop.sends_target = tracks;
        Obstacle& obstacle = loop.add_sphere(loop.target.position_m + Vector3(0.3, 0, 0), Vector3::Zero(), 0.05);
        obstacle.kind = kind;
        loop.run(2.0);
        const Forecast forecast = forecast_of(loop);
        const LinkPoses poses = forward_kinematics(loop.model.arm, loop.arm.position_rad);
        const bool costs = kind == Kind::kPerson && weight > 0.0 && tracks;
        const double expected_s = costs ? (60.0 + 3.0 * 20.0) * person_proximity(poses, &obstacle, 1) : 0.0;
        assert_true(!costs || expected_s > 1.0);
        check_near_because(forecast.proximity_s, expected_s, 0.1 * expected_s, "kind %d, weight %g, tracks %d",
                           static_cast<int>(kind), weight, tracks);
        check_near_because(forecast.cost_s, forecast.proximity_s, 1e-12, "the arm is at its target");
      }
    }
  }
}

/// Of one who stands, but has walked up, an arm at its target knows the nearness to come.
void a_rollout_has_a_person_walk_on_as_predicted(void**) {
  for (const double towards_mps : {-0.4, 0.0, 0.4}) {
    ClosedLoop loop = test::at_home("sidestep");
    loop.model.settings.shield.person_weight = 1e-3;
    loop.target.position_m = forward_kinematics(loop.model.arm, loop.arm.position_rad).tool_position;
    loop.sends_target = true;
    Obstacle& person = loop.add_sphere(loop.target.position_m + Vector3(1.0, 0, 0), Vector3::Zero(), 0.05);
    person.kind = Kind::kPerson;
    loop.run(2.0);
    person.mean_velocity_mps = Vector3(-towards_mps, 0, 0);
    const LinkPoses poses = forward_kinematics(loop.model.arm, loop.arm.position_rad);
    const auto proximity_after = [&](double after_s) {
      const Obstacle then = predicted_obstacle(person, after_s);
      return person_proximity(poses, &then, 1);
    };
    double expected_s = 60.0 * proximity_after(6.0);
    for (int i = 0; i < 300; ++i) expected_s += 20.0 * 0.01 * proximity_after(0.01 * i);
    check_near_because(forecast_of(loop).proximity_s, expected_s, 0.1 * expected_s, "%g m/s", towards_mps);
  }
}

/// The cost counts the whole horizon, although the arm rests soon and its simulation ends.
void an_arm_that_is_stuck_costs_the_whole_horizon_and_one_that_arrived_nothing(void**) {
  ClosedLoop loop = test::tracking("sidestep");
  loop.run(3.0);
  check_near(forecast_of(loop).cost_s, 0.0, 1e-9);
  loop.target.position_m = Vector3(0, 0, 3);
  loop.run(8.0);
  const Forecast stuck = forecast_of(loop);
  assert_false(stuck.arrives);
  check_near(stuck.cost_s, loop.model.settings.foresight.horizon_s + 5.0, 1e-6);
}

void an_arm_at_rest_still_expects_an_obstacle_that_comes_late(void**) {
  ClosedLoop loop = test::tracking("sidestep");
  loop.add_sphere(loop.target.position_m + Vector3(0, 3.0, 0), Vector3(0, -0.6, 0), 0.3);
  const Forecast forecast = forecast_of(loop);
  check(forecast.collides || forecast.cost_s > 0.0, "the sphere, which arrives after 4.5 s, changes nothing");
}

/// 7 mm from a sphere: a contact for an arm that should keep 60 mm, none for one that may pass at 2 mm.
void a_collision_is_judged_by_the_hard_clearance_of_the_settings(void**) {
  ClosedLoop loop = test::tracking("sidestep");
  const LinkPoses poses = forward_kinematics(loop.model.arm, loop.arm.position_rad);
  loop.add_sphere(poses.tool_position + Vector3(0, 0, 0.3), Vector3::Zero(), 0.05);
  Obstacle& sphere = loop.obstacles->obstacles[0];
  for (int i = 0; i < 50; ++i)
    sphere.capsule.start.z() = sphere.capsule.end.z() -=
        clearance_after(loop.model.arm, poses, &sphere, 1, 0.0, 1.0) - 0.007;
  ShieldSettings& shield = loop.model.settings.shield;
  for (const double clearance_m : {0.002, 0.06}) {
    shield.rest_clearance_m = shield.hard_clearance_m = shield.pass_clearance_m = shield.comfort_clearance_m =
        clearance_m;
    assert_int_equal(forecast_of(loop).collides, clearance_m > 0.007);
  }
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
      cmocka_unit_test(of_too_many_obstacles_a_snapshot_keeps_those_that_come_nearest_to_the_arm),
      cmocka_unit_test(a_snapshot_keeps_the_nearest_obstacles_at_rest),
      cmocka_unit_test(a_target_keeps_its_velocity_for_a_second_and_then_rests),
      cmocka_unit_test(the_tool_is_at_the_target_within_10_mm_and_a_twentieth_of_a_radian),
      cmocka_unit_test(a_rollout_with_a_clear_path_arrives_at_the_cost_of_the_time_it_takes),
      cmocka_unit_test(the_near_future_is_forecast_as_it_comes),
      cmocka_unit_test(a_rollout_to_a_target_inside_an_obstacle_does_not_arrive),
      cmocka_unit_test(a_rollout_meets_an_obstacle_that_comes_too_fast),
      cmocka_unit_test(a_rollout_does_not_meet_a_person_who_is_far_away),
      cmocka_unit_test(in_track_the_nearness_of_persons_costs_unless_their_separation_is_off),
      cmocka_unit_test(a_rollout_has_a_person_walk_on_as_predicted),
      cmocka_unit_test(at_a_pose_at_rest_an_arm_that_turns_in_place_costs_half),
      cmocka_unit_test(an_arm_that_is_stuck_costs_the_whole_horizon_and_one_that_arrived_nothing),
      cmocka_unit_test(an_arm_at_rest_still_expects_an_obstacle_that_comes_late),
      cmocka_unit_test(a_collision_is_judged_by_the_hard_clearance_of_the_settings),
      cmocka_unit_test(the_same_snapshot_gives_the_same_forecast_without_allocation),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
