// An operator pauses, resumes and slows the arm (control_t).

#include "firmware/model/prediction.h"
#include "tests/support/check.h"
#include "tests/support/closed_loop.h"
#include "tests/support/lwa3.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::ClosedLoop;
using test::Random;

namespace {

void ask(ClosedLoop& loop, ControlCommand command, double speed_scale = 1.0) {
  loop.control.command = command;
  loop.control.speed_scale = speed_scale;
  loop.sends_control = true;
}

double clearance_m(const ClosedLoop& loop) {
  const LinkPoses poses = forward_kinematics(loop.model.arm, loop.arm.position_rad);
  return clearance_after(loop.model.arm, poses, loop.obstacles->obstacles.data(), loop.obstacles->count, 0.0, 1.0);
}

void a_paused_arm_rests_and_a_resumed_one_tracks(void**) {
  ClosedLoop loop = test::tracking("sidestep");
  ask(loop, ControlCommand::kPause);
  loop.run(0.5);
  assert_true(loop.mode() == Mode::kHold && loop.reports("paused"));
  check_near(loop.last.report.speed_scale, 0.0, 0.0);
  check_near(loop.speed_radps(), 0.0, 1e-3);
  const double left_m = loop.last.report.target_distance_m;
  loop.run(1.0);
  check_near(loop.last.report.target_distance_m, left_m, 1e-3);
  check(left_m > 0.02, "the arm was at its target already");
  ask(loop, ControlCommand::kResume);
  loop.run(2.0);
  assert_true(loop.mode() == Mode::kTrack);
  check(loop.last.report.target_distance_m < 0.005, "%g m away", loop.last.report.target_distance_m);
  test::check_stream(loop);
}

void a_paused_arm_evades(void**) {
  ClosedLoop loop = test::tracking("sidestep");
  ask(loop, ControlCommand::kPause);
  loop.run(0.5);
  const Vector3 tool_m = loop.last.report.tool_position_m;
  loop.add_sphere(tool_m + Vector3(0.0, 0.6, 0.02), Vector3(0, -0.5, 0), 0.05);
  double least_m = 1.0;
  for (int cycle = 0; cycle < 250; ++cycle) {
    loop.cycle();
    assert_true(loop.mode() == Mode::kHold);
    least_m = std::min(least_m, clearance_m(loop));
  }
  check(least_m > 0.015, "%g m", least_m);
  check((loop.last.report.tool_position_m - tool_m).norm() > 0.02, "the arm did not move");
  test::check_stream(loop);
}

/// The way to the target takes 1 / scale as long.
void the_arm_is_as_slow_as_the_operator_wants(void**) {
  const auto fastest_mps = [](double scale, double& arrival_s) {
    ClosedLoop loop = test::at_home("sidestep");
    ask(loop, ControlCommand::kResume, scale);
    loop.sends_target = true;
    assert_true(loop.run_until(Mode::kTrack, 2.0));
    const double start_s = loop.now_s();
    double fastest = 0.0;
    while (loop.last.report.target_distance_m > 0.002 && loop.now_s() < start_s + 20.0) {
      loop.cycle();
      fastest = std::max(fastest, loop.last.report.tool_velocity_mps.norm());
    }
    arrival_s = loop.now_s() - start_s;
    check_near(loop.last.report.speed_scale, scale, 0.0);
    test::check_stream(loop);
    return fastest;
  };
  double full_s = 0.0, half_s = 0.0, tenth_s = 0.0;
  const double full_mps = fastest_mps(1.0, full_s), half_mps = fastest_mps(0.5, half_s);
  const double tenth_mps = fastest_mps(0.1, tenth_s);
  check(half_mps < 0.6 * full_mps && tenth_mps < 0.12 * full_mps, "%g, %g, %g m/s", full_mps, half_mps, tenth_mps);
  check(half_s > 1.4 * full_s && tenth_s > 6.0 * full_s && tenth_s < 20.0, "%g, %g, %g s", full_s, half_s, tenth_s);
}

void at_speed_zero_the_arm_stays(void**) {
  ClosedLoop loop = test::tracking("sidestep");
  ask(loop, ControlCommand::kResume, 0.0);
  loop.run(0.5);
  const JointVector before_rad = loop.arm.position_rad;
  loop.run(1.0);
  assert_true(loop.mode() == Mode::kTrack);
  check_near(loop.arm.position_rad, before_rad, 1e-3);
}

void an_arm_that_needs_an_operator_holds_without_one(void**) {
  ClosedLoop loop = test::at_home("sidestep");
  loop.model.settings.timeouts.control_s = 0.3;
  loop.sends_target = true;
  loop.run(2.0);
  assert_true(loop.mode() == Mode::kHold && loop.reports("the operator is silent"));
  ask(loop, ControlCommand::kResume);
  loop.run(0.1);
  assert_true(loop.mode() == Mode::kTrack);
  loop.sends_control = false;
  loop.run(0.29);
  assert_true(loop.mode() == Mode::kTrack);
  loop.run(0.03);
  assert_true(loop.mode() == Mode::kHold);
  loop.run(0.5);
  check_near(loop.speed_radps(), 0.0, 1e-3);
  test::check_stream(loop);
}

void a_stop_brakes(void**) {
  ClosedLoop loop = test::tracking("sidestep");
  ask(loop, ControlCommand::kStop);
  loop.cycle();
  assert_true(loop.mode() == Mode::kBrake && loop.reports("asked to stop"));
  loop.run(0.5);
  check_near(loop.speed_radps(), 0.0, 0.0);
  test::check_stream(loop);
}

/// Every command is checked; the same scenes without an operator are the measure for contacts.
void at_random_moments_commands_stay_continuous_and_nothing_more_is_touched(void**) {
  int touched = 0, touched_without = 0;
  for (unsigned seed = 0; seed < 1000; ++seed) {
    for (const bool operated : {false, true}) {
      Random random(seed);
      ClosedLoop loop = test::tracking("sidestep");
      loop.target.position_m += random.inside(-0.2, 0.2);
      const Vector3 tool_m = loop.last.report.tool_position_m;
      for (int i = 0; i < 3; ++i) {
        const Vector3 from_m = tool_m + random.direction() * random.uniform(0.45, 0.7);
        const double speed_mps = random.uniform(0.1, 0.5);
        const Vector3 to_m = tool_m + random.inside(-0.1, 0.1);
        loop.add_sphere(from_m, speed_mps * (to_m - from_m).normalized());
        if (clearance_m(loop) < 0.1) --loop.obstacles->count;
      }
      double least_m = 1.0;
      int next = 0;
      for (int cycle = 0; cycle < 200; ++cycle) {
        if (operated && cycle == next) {
          const double scale = random.chance(0.5) ? 1.0 : random.uniform(0.0, 1.0);
          ask(loop, random.chance(0.4) ? ControlCommand::kPause : ControlCommand::kResume, scale);
          next += 1 + random.index(60);
        }
        loop.cycle();
        least_m = std::min(least_m, clearance_m(loop));
      }
      (operated ? touched : touched_without) += least_m <= 0.0;
      test::check_stream(loop);
    }
  }
  print_message("contacts: %d, without an operator %d of 1000\n", touched, touched_without);
  check(touched <= touched_without, "%d contacts, without an operator %d", touched, touched_without);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_paused_arm_rests_and_a_resumed_one_tracks),
      cmocka_unit_test(a_paused_arm_evades),
      cmocka_unit_test(the_arm_is_as_slow_as_the_operator_wants),
      cmocka_unit_test(at_speed_zero_the_arm_stays),
      cmocka_unit_test(an_arm_that_needs_an_operator_holds_without_one),
      cmocka_unit_test(a_stop_brakes),
      cmocka_unit_test(at_random_moments_commands_stay_continuous_and_nothing_more_is_touched),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
