#include "firmware/control/paper/attraction.h"
#include "tests/support/check.h"
#include "tests/support/closed_loop.h"
#include "tests/support/lwa3.h"

using namespace sidestep;
using test::at_home;
using test::check_stream;
using test::ClosedLoop;
using test::home_rad;
using test::tracking;

namespace {

const char* const kLaws[] = {"paper", "sidestep"};

void waits_for_half_a_second_of_arm_state(void**) {
  ClosedLoop loop = at_home("paper");
  loop.sends_target = true;
  loop.sends_arm_state = false;
  loop.run(1.0);
  assert_true(loop.mode() == Mode::kWait && loop.reports("first arm state"));
  assert_int_equal(loop.last.command.position_rad.size(), 0);
  loop.sends_arm_state = true;
  loop.run(0.5);
  assert_true(loop.mode() == Mode::kWait && loop.reports("consistent"));
  assert_int_equal(loop.commands.fed(), 0);
  loop.run(0.02);
  assert_true(loop.mode() == Mode::kTrack || loop.mode() == Mode::kHold);
}

void a_jump_while_waiting_restarts_the_wait(void**) {
  ClosedLoop loop = at_home("paper");
  loop.run(0.4);
  loop.arm.position_rad[2] += 0.2;
  loop.run(0.5);
  assert_true(loop.mode() == Mode::kWait);
  loop.run(0.1);
  assert_true(loop.mode() == Mode::kHold);
}

void waits_for_the_first_obstacles_unless_configured_otherwise(void**) {
  ClosedLoop loop = at_home("paper");
  loop.sends_target = true;
  loop.sends_obstacles = false;
  loop.run(1.0);
  assert_true(loop.mode() == Mode::kWait && loop.reports("obstacle"));
  assert_true(std::isnan(loop.last.report.clearance_m));
  loop.sends_obstacles = true;
  loop.run(0.02);
  assert_true(loop.mode() == Mode::kTrack);
  check_near(loop.last.report.clearance_m, HUGE_VAL, 0);

  ClosedLoop not_waiting = at_home("paper");
  not_waiting.model.settings.wait_for_obstacles = false;
  not_waiting.sends_target = true;
  not_waiting.sends_obstacles = false;
  not_waiting.run(0.6);
  assert_true(not_waiting.mode() == Mode::kTrack);
}

void holds_without_a_target_and_tracks_with_one(void**) {
  for (const char* law : kLaws) {
    ClosedLoop loop = at_home(law);
    loop.run(1.0);
    assert_true(loop.mode() == Mode::kHold && loop.reports("no target"));
    check_near(loop.arm.position_rad, home_rad(), 0);
    assert_true(std::isnan(loop.last.report.target_distance_m));
    loop.sends_target = true;
    loop.run(10.0);
    assert_true(loop.mode() == Mode::kTrack);
    check(loop.last.report.target_distance_m < 1e-3, "%s: %g m left", law, loop.last.report.target_distance_m);
    check_near(loop.last.report.target_distance_m, (loop.target.position_m - loop.last.report.tool_position_m).norm(),
               1e-9);
    check_stream(loop);
  }
}

void a_request_to_stop_brakes_to_rest(void**) {
  for (const char* law : kLaws) {
    ClosedLoop loop = tracking(law);
    loop.stop = true;
    loop.cycle();
    assert_true(loop.mode() == Mode::kBrake && loop.reports("stop"));
    double speed = loop.speed_radps();
    for (int i = 0; i < 25; ++i) {
      loop.cycle();
      assert_true(loop.mode() == Mode::kBrake && loop.speed_radps() <= speed);
      speed = loop.speed_radps();
    }
    check_near(speed, 0.0, 0);
    check_stream(loop);
  }
}

void one_late_cycle_is_reported_and_three_in_a_row_brake(void**) {
  ClosedLoop loop = tracking("paper");
  loop.skipped = 2;
  loop.cycle();
  assert_true(loop.mode() == Mode::kTrack && (loop.last.report.limiting & kLimitingLate));
  loop.skipped = 0;
  loop.cycle();
  assert_true(loop.mode() == Mode::kTrack && !(loop.last.report.limiting & kLimitingLate));
  loop.skipped = 1;
  loop.cycle();
  loop.cycle();
  assert_true(loop.mode() == Mode::kTrack);
  loop.cycle();
  assert_true(loop.mode() == Mode::kBrake && loop.reports("skipped"));
  loop.skipped = 0;
  loop.cycle();
  assert_true(loop.mode() == Mode::kTrack);
}

void a_nominal_velocity_that_is_not_finite_is_a_fault_and_brakes(void**) {
  for (const char* law : kLaws) {
    for (const double bad : {std::nan(""), HUGE_VAL, 1e308}) {
      ClosedLoop loop = tracking(law);
      const Vector3 good_m = loop.target.position_m;
      loop.target.position_m = Vector3(bad, -bad, bad);
      loop.cycle();
      check(loop.mode() == Mode::kFault && loop.last.report.fault == Fault::kNotFinite, "%s, target %g: %s", law, bad,
            loop.last.report.message);
      loop.target.position_m = good_m;
      loop.run(0.45);
      assert_true(loop.mode() == Mode::kFault && loop.last.report.fault == Fault::kNotFinite);
      check_near(loop.speed_radps(), 0.0, 0);
      loop.run(0.1);
      assert_true(loop.mode() == Mode::kTrack);
      check_stream(loop);
    }
  }
}

/// With `tool_velocity: planned` tracking always starts from the measured velocity.
void planned_velocity_is_discarded_while_holding(void**) {
  ClosedLoop loop = tracking("paper");
  loop.model.settings.paper.tool_velocity = ToolVelocity::kPlanned;
  loop.run(0.3);
  assert_true(loop.state.planned.valid && loop.state.planned.velocity_mps.norm() > 0.02);
  loop.sends_target = false;
  loop.run(0.6);
  assert_false(loop.state.planned.valid);
  check_near(loop.speed_radps(), 0.0, 0);
  loop.sends_target = true;
  loop.cycle();
  assert_true(loop.mode() == Mode::kTrack && loop.state.planned.valid);
  const Vector3 force =
      attraction(loop.model.settings.paper, loop.target, loop.last.report.tool_position_m, Vector3(0, 0, 0));
  check_near(loop.state.planned.velocity_mps, Vector3(force * loop.model.settings.period_s()), 1e-12);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(waits_for_half_a_second_of_arm_state),
      cmocka_unit_test(a_jump_while_waiting_restarts_the_wait),
      cmocka_unit_test(waits_for_the_first_obstacles_unless_configured_otherwise),
      cmocka_unit_test(holds_without_a_target_and_tracks_with_one),
      cmocka_unit_test(a_request_to_stop_brakes_to_rest),
      cmocka_unit_test(one_late_cycle_is_reported_and_three_in_a_row_brake),
      cmocka_unit_test(a_nominal_velocity_that_is_not_finite_is_a_fault_and_brakes),
      cmocka_unit_test(planned_velocity_is_discarded_while_holding),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
