#include "firmware/control/attraction.h"
#include "tests/support/check.h"
#include "tests/support/closed_loop.h"
#include "tests/support/lwa3.h"

using namespace sidestep;
using test::ClosedLoop;
using test::home_rad;
using test::lwa3_model;

namespace {

const char* const kLaws[] = {"paper", "sidestep"};

bool says(const ClosedLoop& loop, const char* words) {
  return loop.message().find(words) != std::string::npos;
}

/// At home with a target 20 cm away that is not sent yet.
ClosedLoop at_home(const std::string& law = "paper") {
  ClosedLoop loop(lwa3_model(law), home_rad());
  loop.target.position_m = Vector3(-0.328, 0.15, 0.8);
  return loop;
}

ClosedLoop tracking(const std::string& law = "paper") {
  ClosedLoop loop = at_home(law);
  loop.target_speaks = true;
  check(loop.run_until(Mode::kTrack, 1.0), "%s", loop.message().c_str());
  loop.run(0.3);
  check(loop.mode() == Mode::kTrack && loop.speed_radps() > 0.05, "%s at %g rad/s", loop.message().c_str(),
        loop.speed_radps());
  return loop;
}

void check_stream(const ClosedLoop& loop) {
  check(loop.commands.complaint().empty(), "%s", loop.commands.complaint().c_str());
}

void waits_for_half_a_second_of_arm_state(void**) {
  ClosedLoop loop = at_home();
  loop.target_speaks = true;
  loop.arm_speaks = false;
  loop.run(1.0);
  assert_true(loop.mode() == Mode::kWait && says(loop, "first arm state"));
  assert_int_equal(loop.last.command.position_rad.size(), 0);
  loop.arm_speaks = true;
  loop.run(0.5);
  assert_true(loop.mode() == Mode::kWait && says(loop, "consistent"));
  assert_int_equal(loop.commands.fed(), 0);
  loop.run(0.02);
  assert_true(loop.mode() == Mode::kTrack || loop.mode() == Mode::kHold);
}

void a_jump_while_waiting_starts_the_wait_anew(void**) {
  ClosedLoop loop = at_home();
  loop.run(0.4);
  loop.arm.position_rad[2] += 0.2;
  loop.run(0.5);
  assert_true(loop.mode() == Mode::kWait);
  loop.run(0.02);
  assert_true(loop.mode() == Mode::kHold);
}

void waits_for_the_first_obstacles_unless_told_otherwise(void**) {
  ClosedLoop loop = at_home();
  loop.target_speaks = true;
  loop.obstacles_speak = false;
  loop.run(1.0);
  assert_true(loop.mode() == Mode::kWait && says(loop, "obstacle"));
  assert_true(std::isnan(loop.last.report.clearance_m));
  loop.obstacles_speak = true;
  loop.run(0.02);
  assert_true(loop.mode() == Mode::kTrack);
  check_near(loop.last.report.clearance_m, HUGE_VAL, 0);

  ClosedLoop trusting = at_home();
  trusting.model.settings.wait_for_obstacles = false;
  trusting.target_speaks = true;
  trusting.obstacles_speak = false;
  trusting.run(0.6);
  assert_true(trusting.mode() == Mode::kTrack);
}

void holds_without_a_target_and_tracks_with_one(void**) {
  for (const char* law : kLaws) {
    ClosedLoop loop = at_home(law);
    loop.run(1.0);
    assert_true(loop.mode() == Mode::kHold && says(loop, "no target"));
    check_near(loop.arm.position_rad, home_rad(), 0);
    assert_true(std::isnan(loop.last.report.target_distance_m));
    loop.target_speaks = true;
    loop.run(10.0);
    assert_true(loop.mode() == Mode::kTrack);
    check(loop.last.report.target_distance_m < 1e-3, "%s: %g m left", law, loop.last.report.target_distance_m);
    check_near(loop.last.report.target_distance_m, (loop.target.position_m - loop.last.report.tool_position_m).norm(),
               1e-9);
    check_stream(loop);
  }
}

void an_old_target_is_held_and_a_new_one_tracked_again(void**) {
  for (const char* law : kLaws) {
    ClosedLoop loop = tracking(law);
    loop.target_speaks = false;
    loop.run(0.25);
    assert_true(loop.mode() == Mode::kTrack);
    loop.run(0.02);
    assert_true(loop.mode() == Mode::kHold && says(loop, "target is too old"));
    loop.run(0.5);
    check_near(loop.speed_radps(), 0.0, 0);
    loop.target_speaks = true;
    loop.run(0.1);
    assert_true(loop.mode() == Mode::kTrack);
    assert_true(loop.speed_radps() > 0);
    check_stream(loop);
  }
}

void old_obstacles_brake_and_grow(void**) {
  for (const char* law : kLaws) {
    ClosedLoop loop = tracking(law);
    loop.add_sphere(Vector3(1.5, 0, 0.5), Vector3(0, 0, 0));
    loop.run(0.1);
    loop.obstacles_speak = false;
    loop.run(0.1);
    assert_true(loop.mode() == Mode::kTrack);
    const double before_m = loop.last.report.clearance_m;
    loop.run(0.02);
    assert_true(loop.mode() == Mode::kBrake && says(loop, "obstacles are too old"));
    loop.run(0.5);
    check_near(loop.speed_radps(), 0.0, 0);
    const double shrunk_m = before_m - loop.last.report.clearance_m;
    check(shrunk_m > 0.6 * loop.model.settings.obstacle_speed_bound_mps - 0.1, "the obstacle grew by %g m", shrunk_m);
    loop.obstacles_speak = true;
    loop.run(0.1);
    assert_true(loop.mode() == Mode::kTrack);
    check_stream(loop);
  }
}

void a_short_gap_of_arm_states_brakes_and_a_long_one_is_a_fault(void**) {
  for (const char* law : kLaws) {
    ClosedLoop loop = tracking(law);
    loop.arm_speaks = false;
    loop.run(0.03);
    assert_true(loop.mode() == Mode::kTrack);
    loop.run(0.01);
    assert_true(loop.mode() == Mode::kBrake && says(loop, "arm state is too old"));
    loop.arm_speaks = true;
    loop.run(0.02);
    assert_true(loop.mode() == Mode::kTrack);
    loop.arm_speaks = false;
    loop.run(0.11);
    assert_true(loop.mode() == Mode::kFault && loop.last.report.fault == Fault::kArmStateLost);
    loop.run(1.0);
    assert_false(loop.last.commanding);
    loop.arm_speaks = true;
    loop.run(0.49);
    assert_true(loop.mode() == Mode::kFault && says(loop, "consistent"));
    loop.run(0.04);
    assert_true(loop.mode() == Mode::kTrack && loop.last.report.fault == Fault::kNone);
    check_stream(loop);
  }
}

void asked_to_stop_it_brakes_to_rest_for_good(void**) {
  for (const char* law : kLaws) {
    ClosedLoop loop = tracking(law);
    loop.stop = true;
    loop.cycle();
    assert_true(loop.mode() == Mode::kBrake && says(loop, "stop"));
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

void an_arm_that_jumps_is_a_fault_and_goes_on_from_where_it_is(void**) {
  for (const char* law : kLaws) {
    ClosedLoop loop = tracking(law);
    loop.arm.position_rad[0] += 0.5;
    loop.cycle();
    assert_true(loop.mode() == Mode::kFault && loop.last.report.fault == Fault::kArmStateInconsistent);
    loop.run(0.48);
    assert_true(loop.mode() == Mode::kFault);
    loop.run(0.05);
    assert_true(loop.mode() == Mode::kTrack);
    loop.run(8.0);
    check(loop.last.report.target_distance_m < 2e-3, "%s: %g m left", law, loop.last.report.target_distance_m);
    check_stream(loop);
  }
}

void one_late_cycle_is_noted_and_three_in_a_row_brake(void**) {
  ClosedLoop loop = tracking();
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
  assert_true(loop.mode() == Mode::kBrake && says(loop, "skipped"));
  loop.skipped = 0;
  loop.cycle();
  assert_true(loop.mode() == Mode::kTrack);
}

void a_wish_that_is_not_finite_is_a_fault_and_brakes(void**) {
  for (const char* law : kLaws) {
    for (const double bad : {std::nan(""), HUGE_VAL, 1e308}) {
      ClosedLoop loop = tracking(law);
      const Vector3 good_m = loop.target.position_m;
      loop.target.position_m = Vector3(bad, -bad, bad);
      loop.cycle();
      check(loop.mode() == Mode::kFault && loop.last.report.fault == Fault::kNotFinite, "%s, target %g: %s", law, bad,
            loop.message().c_str());
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

/// tool_velocity: planned starts anew from the measured velocity whenever the arm was not tracking.
void planned_velocity_is_forgotten_while_holding(void**) {
  ClosedLoop loop = tracking("paper");
  loop.model.settings.paper.tool_velocity = ToolVelocity::kPlanned;
  loop.run(0.3);
  assert_true(loop.state.planning && loop.state.planned_mps.norm() > 0.02);
  loop.target_speaks = false;
  loop.run(0.6);
  assert_false(loop.state.planning);
  check_near(loop.speed_radps(), 0.0, 0);
  loop.target_speaks = true;
  loop.cycle();
  assert_true(loop.mode() == Mode::kTrack && loop.state.planning);
  const Vector3 force =
      attraction(loop.model.settings.paper, loop.target, loop.last.report.tool_position_m, Vector3(0, 0, 0));
  check_near(loop.state.planned_mps, Vector3(force * loop.model.settings.period_s()), 1e-12);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(waits_for_half_a_second_of_arm_state),
      cmocka_unit_test(a_jump_while_waiting_starts_the_wait_anew),
      cmocka_unit_test(waits_for_the_first_obstacles_unless_told_otherwise),
      cmocka_unit_test(holds_without_a_target_and_tracks_with_one),
      cmocka_unit_test(an_old_target_is_held_and_a_new_one_tracked_again),
      cmocka_unit_test(old_obstacles_brake_and_grow),
      cmocka_unit_test(a_short_gap_of_arm_states_brakes_and_a_long_one_is_a_fault),
      cmocka_unit_test(asked_to_stop_it_brakes_to_rest_for_good),
      cmocka_unit_test(an_arm_that_jumps_is_a_fault_and_goes_on_from_where_it_is),
      cmocka_unit_test(one_late_cycle_is_noted_and_three_in_a_row_brake),
      cmocka_unit_test(a_wish_that_is_not_finite_is_a_fault_and_brakes),
      cmocka_unit_test(planned_velocity_is_forgotten_while_holding),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
