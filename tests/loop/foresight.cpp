#include "firmware/foresight/foresight.h"

#include <cstring>

#include "tests/support/allocation_count.h"
#include "tests/support/check.h"
#include "tests/support/foresight_loop.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::ClosedLoop;

namespace {

/// The arm at home, with and without foresight.
struct World : test::ForesightLoop {
  World(const Vector3& target_m, bool enabled)
      : ForesightLoop(test::point_target(target_m), test::home_rad(), "sidestep", enabled) {}

  /// A horizontal bar and a vertical post below it, both across the straight path of the forearm.
  void add_bar() {
    for (int i = 0; i < 9; ++i) loop.add_sphere(Vector3(0.32, -0.28 + 0.07 * i, 0.72), Vector3::Zero(), 0.07);
    for (int i = 0; i < 5; ++i) loop.add_sphere(Vector3(0.32, 0.0, 0.44 + 0.07 * i), Vector3::Zero(), 0.07);
  }
};

const Vector3 kBehindTheBar(0.62, 0.0, 0.62);

void the_arm_arrives_behind_a_bar_that_blocks_the_direct_path(void**) {
  World world(kBehindTheBar, true);
  world.add_bar();
  bool guided = false;
  for (int i = 0; i < 1200; ++i) {
    world.cycle();
    guided |= world.guide->knots > 0;
  }
  check(world.least_m > 0.01, "%g m", world.least_m);
  test::check_stream(world.loop);
  check(world.error_m() < 0.01, "%g m from the target", world.error_m());
  check(guided, "foresight needed no guide: the bar does not block the direct path");
}

void without_foresight_the_arm_keeps_clear_of_the_bar(void**) {
  World world(kBehindTheBar, false);
  world.add_bar();
  world.run(12.0);
  check(world.least_m >= world.loop.model.settings.shield.rest_clearance_m, "%g m", world.least_m);
  test::check_stream(world.loop);
}

void there_is_no_guide_where_the_law_arrives_without_one(void**) {
  World world(Vector3(-0.328, 0.15, 0.8), true);
  for (int i = 0; i < 400; ++i) {
    world.cycle();
    check(!world.guide || world.guide->knots == 0, "a guide at cycle %d", i);
    assert_int_equal(static_cast<int>(world.loop.last.report.foresight_status),
                     static_cast<int>(ForesightStatus::kDirect));
  }
  check(world.error_m() < 1e-3, "%g m", world.error_m());
}

/// Until the tool is within 10 mm and 0.05 rad for good, of 5 s.
double arrival_s(World& world) {
  double arrival_s = 0.0;
  for (int i = 1; i <= 500; ++i) {
    world.cycle();
    const LinkPoses poses = forward_kinematics(world.loop.model.arm, world.loop.arm.position_rad);
    if (!is_at(poses, world.loop.target)) arrival_s = 0.01 * i;
  }
  return arrival_s;
}

/// The pose that the tool has in a random configuration.
void aim_at_a_pose(World& world, test::Random& random) {
  const LinkPoses goal = forward_kinematics(world.loop.model.arm, random.configuration(world.loop.model.arm, 0.9));
  world.loop.target.position_m = goal.tool_position;
  world.loop.target.tracks_orientation = true;
  world.loop.target.orientation = Quaternion(goal.tool_rotation);
}

void where_everything_rests_a_guide_that_is_clearly_faster_replaces_the_law(void**) {
  int faster = 0;
  double saved_s = 0.0;
  for (uint64_t seed = 1; seed <= 60; ++seed) {
    test::Random with(seed), without(seed);
    World world(Vector3::Zero(), true), law(Vector3::Zero(), false);
    aim_at_a_pose(world, with);
    aim_at_a_pose(law, without);
    const double law_s = arrival_s(law), world_s = arrival_s(world);
    test::check_stream(world.loop);
    if (law_s > 3.9) continue;  // the law is no good
    check(world_s < law_s + 0.1, "seed %d: %g s, the law %g s", static_cast<int>(seed), world_s, law_s);
    saved_s += law_s - world_s;
    if (world_s < law_s - 0.15) ++faster;
  }
  check(faster >= 3 && saved_s > 1.0, "%d were faster, by %g s", faster, saved_s);
}

void where_an_obstacle_moves_no_guide_replaces_a_law_that_arrives(void**) {
  int arrived = 0;
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    test::Random with(seed), without(seed);
    World world(Vector3::Zero(), true), law(Vector3::Zero(), false);
    aim_at_a_pose(world, with);
    aim_at_a_pose(law, without);
    for (World* one : {&world, &law}) one->loop.add_sphere(Vector3(1.6, 0.0, 0.5), Vector3(-0.01, 0.0, 0.0), 0.1);
    if (arrival_s(law) > 3.5) continue;
    ++arrived;
    for (int i = 0; i < 200; ++i) {
      world.cycle();
      assert_int_equal(world.guide->knots, 0);
    }
  }
  check(arrived >= 10, "the law arrived %d times", arrived);
}

void the_same_inputs_give_the_same_guides(void**) {
  World one(kBehindTheBar, true), other(kBehindTheBar, true);
  one.add_bar();
  other.add_bar();
  int guided = 0;
  for (int i = 0; i < 500; ++i) {
    one.cycle();
    other.cycle();
    assert_int_equal(one.guide->knots, other.guide->knots);
    for (int k = 0; k < one.guide->knots; ++k) {
      const auto at = static_cast<size_t>(k);
      assert_true(one.guide->time_s[at] == other.guide->time_s[at]);
      assert_true(one.guide->position_rad[at] == other.guide->position_rad[at]);
    }
    if (one.guide->knots > 0) ++guided;
  }
  check(guided > 20, "only %d cycles with a guide", guided);
}

void guides_keep_the_joint_limits(void**) {
  World world(kBehindTheBar, true);
  world.add_bar();
  const JointLimits& limits = world.loop.model.arm.limits;
  int points = 0;
  for (int i = 0; i < 700; ++i) {
    world.cycle();
    if (world.guide->knots == 0) continue;
    for (double at_s = world.guide->time_s[0]; at_s < world.guide->end_s(); at_s += 0.1) {
      const GuidePoint point = point_of(*world.guide, at_s);
      ++points;
      assert_true((point.velocity_radps.cwiseAbs().array() <= limits.velocity_radps.array()).all());
      assert_true((point.position_rad.array() >= limits.lower_rad.array() - 1e-9).all());
      assert_true((point.position_rad.array() <= limits.upper_rad.array() + 1e-9).all());
    }
  }
  check(points > 100, "only %d points", points);
}

void a_blocked_guide_is_dropped_within_100_ms(void**) {
  World world(kBehindTheBar, true);
  world.add_bar();
  int cycles = 0;
  while ((!world.guide || world.guide->knots < 2) && ++cycles < 500) world.cycle();
  check(cycles < 500, "no guide");
  const Guide old = *world.guide;
  // A sphere at the end of the guide blocks it.
  const LinkPoses end = forward_kinematics(world.loop.model.arm, point_of(old, old.end_s()).position_rad);
  world.loop.add_sphere(end.tool_position, Vector3::Zero(), 0.25);
  for (int i = 0; i < 10; ++i) world.cycle();
  const bool kept = world.guide->knots == old.knots && world.guide->position_rad[1] == old.position_rad[1];
  check(!kept, "the old guide is still followed");
}

void the_status_is_waiting_if_the_target_is_unreachable(void**) {
  World world(Vector3(2.0, 0.0, 0.5), true);
  world.run(4.0);
  assert_int_equal(static_cast<int>(world.loop.last.report.foresight_status),
                   static_cast<int>(ForesightStatus::kWaiting));
  test::check_stream(world.loop);
}

void foresight_does_not_allocate(void**) {
  World world(kBehindTheBar, true);
  world.add_bar();
  world.run(0.7);
  const int64_t before = test::allocation_count();
  world.run(3.0);
  const int64_t after = test::allocation_count();
  // ClosedLoop does not allocate once it has sent each message once.
  assert_int_equal(after - before, 0);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(the_arm_arrives_behind_a_bar_that_blocks_the_direct_path),
      cmocka_unit_test(without_foresight_the_arm_keeps_clear_of_the_bar),
      cmocka_unit_test(there_is_no_guide_where_the_law_arrives_without_one),
      cmocka_unit_test(where_everything_rests_a_guide_that_is_clearly_faster_replaces_the_law),
      cmocka_unit_test(where_an_obstacle_moves_no_guide_replaces_a_law_that_arrives),
      cmocka_unit_test(the_same_inputs_give_the_same_guides),
      cmocka_unit_test(guides_keep_the_joint_limits),
      cmocka_unit_test(a_blocked_guide_is_dropped_within_100_ms),
      cmocka_unit_test(the_status_is_waiting_if_the_target_is_unreachable),
      cmocka_unit_test(foresight_does_not_allocate),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
