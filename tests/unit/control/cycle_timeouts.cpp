#include <algorithm>
#include <cmath>
#include <vector>

#include "firmware/control/extrapolation.h"
#include "tests/support/check.h"
#include "tests/support/closed_loop.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::check_stream;
using test::ClosedLoop;
using test::tracking;

namespace {

const char* const kLaws[] = {"paper", "sidestep"};

void an_old_target_leads_to_hold_and_a_new_one_to_track(void**) {
  for (const char* law : kLaws) {
    ClosedLoop loop = tracking(law);
    loop.sends_target = false;
    loop.run(0.25);
    assert_true(loop.mode() == Mode::kTrack);
    loop.run(0.02);
    assert_true(loop.mode() == Mode::kHold && loop.reports("target is too old"));
    loop.run(0.5);
    check_near(loop.speed_radps(), 0.0, 0);
    loop.sends_target = true;
    loop.run(0.1);
    assert_true(loop.mode() == Mode::kTrack);
    assert_true(loop.speed_radps() > 0);
    check_stream(loop);
  }
}

/// In HOLD the arm evades a sphere; the pose moved when its messages stopped, or rested.
void the_motion_of_an_old_target_does_not_change_how_the_arm_evades(void**) {
  ClosedLoop loop = tracking("sidestep");
  loop.target.tracks_orientation = true;
  loop.target.orientation = Quaternion(forward_kinematics(loop.model.arm, loop.arm.position_rad).tool_rotation);
  loop.run(1.0);
  loop.sends_target = false;
  assert_true(loop.run_until(Mode::kHold, 1.0));
  loop.run(0.5);
  const LinkPoses poses = forward_kinematics(loop.model.arm, loop.arm.position_rad);
  loop.add_sphere(0.5 * (poses.origin[3] + poses.tool_position) + Vector3(0.5, 0, 0), Vector3(-1, 0, 0));
  double fastest_radps = 0.0;
  for (int cycle = 0; cycle < 60; ++cycle) {
    Inputs inputs = loop.receive();
    Target moving = *inputs.target.message, resting = moving;
    moving.velocity_mps = Vector3(0.1, 0.2, 0);
    moving.angular_velocity_radps = Vector3(0, 0, 0.3);
    resting.velocity_mps = resting.angular_velocity_radps = Vector3::Zero();
    inputs.target.message = &resting;
    const Result rested = step(loop.model, loop.state, inputs, loop.now_s());
    inputs.target.message = &moving;
    const Result moved = step(loop.model, loop.state, inputs, loop.now_s());
    assert_true(moved.report.mode == Mode::kHold);
    check_near_because(moved.command.position_rad, rested.command.position_rad, 0.0, "cycle %d", cycle);
    fastest_radps = std::max(fastest_radps, rested.command.velocity_radps.norm());
    loop.follow(rested);
  }
  check(fastest_radps > 0.2, "the arm evades with only %g rad/s", fastest_radps);
  check_stream(loop);
}

void old_obstacles_brake_and_grow(void**) {
  for (const char* law : kLaws) {
    ClosedLoop loop = tracking(law);
    loop.add_sphere(Vector3(1.5, 0, 0.5), Vector3(0, 0, 0));
    loop.run(0.1);
    loop.sends_obstacles = false;
    loop.run(0.1);
    assert_true(loop.mode() == Mode::kTrack);
    const double before_m = loop.last.report.clearance_m;
    loop.run(0.02);
    assert_true(loop.mode() == Mode::kBrake && loop.reports("obstacles are too old"));
    loop.run(0.5);
    check_near(loop.speed_radps(), 0.0, 0);
    const double shrunk_m = before_m - loop.last.report.clearance_m;
    check(shrunk_m > 0.6 * loop.model.settings.obstacle_speed_bound_mps - 0.1, "the obstacle grew by %g m", shrunk_m);
    loop.sends_obstacles = true;
    loop.run(0.1);
    assert_true(loop.mode() == Mode::kTrack);
    check_stream(loop);
  }
}

/// Neither after a wait nor after a fault.
void the_arm_does_not_start_on_old_obstacles(void**) {
  for (const char* law : kLaws) {
    ClosedLoop loop = test::at_home(law);
    loop.add_sphere(Vector3(-0.3, 0.1, 0.8), Vector3(0, 0, 0));
    loop.sends_arm_state = false;
    loop.run(0.1);
    loop.sends_obstacles = false;
    const auto stands_still = [&](Mode mode) {
      const JointVector before_rad = loop.arm.position_rad;
      loop.sends_arm_state = true;
      for (int cycle = 0; cycle < 200; ++cycle) {
        loop.cycle();
        check(loop.mode() == mode && !loop.last.commanding, "%s: mode %d", law, static_cast<int>(loop.mode()));
      }
      assert_true(loop.reports("obstacles are too old"));
      check_near(loop.arm.position_rad, before_rad, 0);
    };
    stands_still(Mode::kWait);
    loop.sends_obstacles = true;
    assert_true(loop.run_until(Mode::kHold, 0.1));
    loop.run(0.5);
    loop.sends_obstacles = loop.sends_arm_state = false;
    assert_true(loop.run_until(Mode::kFault, 0.5));
    loop.run(1.0);
    stands_still(Mode::kFault);
    check_stream(loop);
  }
}

/// A restarted lockstep simulator sets the clock back, so that the last obstacles were received in the future. Such
/// obstacles count at least at their reported positions.
void obstacles_received_in_the_future_are_not_farther_away(void**) {
  const Model model = test::lwa3_model("sidestep");
  ObstacleSet set;
  set.count = 1;
  set.obstacles[0] = sphere_obstacle(Vector3(1, 0, 0.5), 0.1);
  set.obstacles[0].velocity_mps = Vector3(-1, 0, 0);
  const ObstacleView view = view_obstacles(model, {&set, 1000.0, 1}, 0.0);
  const Capsule seen = view.at(0).capsule;
  check(seen.radius_m >= 0.1 && seen.start.x() <= 1.0, "radius %g m at %g m", seen.radius_m, seen.start.x());
}

void a_short_gap_of_arm_states_brakes_and_a_long_one_is_a_fault(void**) {
  for (const char* law : kLaws) {
    ClosedLoop loop = tracking(law);
    loop.sends_arm_state = false;
    loop.run(0.03);
    assert_true(loop.mode() == Mode::kTrack);
    loop.run(0.01);
    assert_true(loop.mode() == Mode::kBrake && loop.reports("arm state is too old"));
    loop.sends_arm_state = true;
    loop.run(0.02);
    assert_true(loop.mode() == Mode::kTrack);
    loop.sends_arm_state = false;
    loop.run(0.11);
    assert_true(loop.mode() == Mode::kFault && loop.last.report.fault == Fault::kArmStateLost);
    loop.run(1.0);
    assert_false(loop.last.commanding);
    loop.sends_arm_state = true;
    loop.run(0.49);
    assert_true(loop.mode() == Mode::kFault && loop.reports("consistent"));
    loop.run(0.04);
    assert_true(loop.mode() == Mode::kTrack && loop.last.report.fault == Fault::kNone);
    check_stream(loop);
  }
}

void an_arm_that_jumps_is_a_fault_and_continues_from_its_new_position(void**) {
  for (const char* law : kLaws) {
    ClosedLoop loop = tracking(law);
    loop.arm.position_rad[0] += 0.5;
    loop.run(0.12);
    assert_true(loop.mode() == Mode::kFault && loop.last.report.fault == Fault::kArmStateInconsistent);
    loop.run(0.3);
    assert_false(loop.last.commanding);
    loop.run(0.16);
    assert_true(loop.mode() == Mode::kFault);
    loop.run(0.05);
    assert_true(loop.mode() == Mode::kTrack);
    check_near(loop.last.command.position_rad, loop.arm.position_rad, 0.02);
    loop.run(8.0);
    check(loop.last.report.target_distance_m < 2e-3, "%s: %g m left", law, loop.last.report.target_distance_m);
    check_stream(loop);
  }
}

/// The elapsed time by the arm's clock counts only as far as the controller's clock confirms it.
void an_arm_whose_clock_runs_ahead_may_not_jump(void**) {
  for (const char* law : kLaws) {
    ClosedLoop loop = tracking(law);
    loop.arm_clock_offset_us += 5'000'000;
    loop.arm.position_rad[0] += 0.5;
    loop.run(0.12);
    check(loop.mode() == Mode::kFault && loop.last.report.fault == Fault::kArmStateInconsistent, "%s: %s", law,
          loop.last.report.message);

    test::Random random(1);
    ClosedLoop jumping = test::at_home(law);
    jumping.sends_target = true;
    for (int cycle = 0; cycle < 300; ++cycle) {
      jumping.arm.position_rad = random.configuration(jumping.model.arm, 0.9);
      jumping.arm_clock_offset_us += 3'000'000;
      jumping.cycle();
      check(jumping.mode() == Mode::kWait && !jumping.last.commanding, "%s: %s", law, jumping.last.report.message);
    }
  }
}

/// In lockstep the arm's states are the clock, so that no cycle runs during a silence.
void a_silence_of_the_arm_counts_where_its_states_are_the_clock(void**) {
  for (const char* law : kLaws) {
    const struct {
      double silence_s, moved_rad;
      Mode mode;
    } cases[] = {
        {0.02, 0.0, Mode::kTrack}, {0.05, 0.0, Mode::kBrake}, {0.15, 0.0, Mode::kFault}, {2.0, 0.8, Mode::kFault}};
    for (const auto& each : cases) {
      ClosedLoop loop = tracking(law);
      Inputs inputs = loop.receive();
      ArmState arm = *inputs.arm.message;
      const double now_s = loop.state.arm_monitor.received_s + each.silence_s;
      arm.utime = loop.state.arm_monitor.accepted.state.utime + std::llround(each.silence_s * 1e6);
      arm.position_rad[0] += each.moved_rad;
      inputs.arm = {&arm, now_s, loop.state.arm_monitor.count + 1};
      inputs.target.received_s = inputs.obstacles.received_s = now_s;
      const Result result = step(loop.model, loop.state, inputs, now_s);
      check(result.report.mode == each.mode, "%s, %g s: %s", law, each.silence_s, result.report.message);
      if (each.mode != Mode::kFault) check(result.commanding, "%s, %g s", law, each.silence_s);
      if (each.moved_rad > 0.0) check(!result.commanding, "%s, %g s", law, each.silence_s);
      check_near(result.command.position_rad, arm.position_rad, 0.1);
    }
  }
}

/// The arm has stopped by itself during the pause. Commands start from its position, once a state has been received
/// after it stopped.
void after_a_pause_of_the_controller_commands_start_from_the_arms_position(void**) {
  const double pause_s = 0.08;
  const struct {
    double arm_received_s;  // after the last cycle
    Mode mode;
    bool commanding;
  } cases[] = {{0.0, Mode::kBrake, false}, {0.055, Mode::kBrake, false}, {0.07, Mode::kBrake, true}};
  for (const char* law : kLaws) {
    for (const auto& each : cases) {
      ClosedLoop loop = tracking(law);
      assert_true(loop.speed_radps() > 0.15);
      Inputs inputs = loop.receive();
      ArmState arm = *inputs.arm.message;
      arm.velocity_radps.setZero();
      arm.utime = loop.state.arm_monitor.accepted.state.utime + std::llround(each.arm_received_s * 1e6);
      const double last_s = loop.state.arm_monitor.cycle_s, now_s = last_s + pause_s;
      if (each.arm_received_s > 0.0)
        inputs.arm = {&arm, last_s + each.arm_received_s, loop.state.arm_monitor.count + 5};
      inputs.target.received_s = inputs.obstacles.received_s = now_s;
      inputs.skipped_cycles = 7;
      const Result result = step(loop.model, loop.state, inputs, now_s);
      check(result.report.mode == each.mode, "%s, %g s: %s", law, each.arm_received_s, result.report.message);
      check(result.commanding == each.commanding, "%s, %g s", law, each.arm_received_s);
      if (!each.commanding) continue;
      check_near(result.command.velocity_radps.norm(), 0.0, 0);
      check_near(result.command.position_rad, arm.position_rad, 1e-12);
    }
  }
}

void a_foreign_command_counts_for_half_a_second(void**) {
  for (const double ago_s : {0.0, 0.4, 0.6, -0.01}) {
    ClosedLoop loop = tracking("sidestep");
    Inputs inputs = loop.receive();
    inputs.foreign_command_s = loop.now_s() - ago_s;
    const Result result = step(loop.model, loop.state, inputs, loop.now_s());
    const bool counts = ago_s < 0.5;
    check((result.report.mode == Mode::kBrake) == counts, "%g s ago: %s", ago_s, result.report.message);
  }
}

void an_arm_whose_clock_stops_or_goes_back_is_a_fault(void**) {
  for (const int64_t offset_us : {-10000, -20000, -50000}) {
    ClosedLoop loop = tracking("paper");
    loop.arm_clock_offset_us = offset_us;
    loop.cycle();
    check(loop.mode() == Mode::kFault && loop.last.report.fault == Fault::kArmStateInconsistent, "%ld us: %s",
          offset_us, loop.last.report.message);
    loop.run(0.6);
    assert_true(loop.mode() == Mode::kTrack);
  }
}

/// A report every tenth cycle gives the same commands as a report every cycle.
void target_and_obstacles_are_extrapolated_to_the_current_cycle(void**) {
  for (const char* law : kLaws) {
    const auto play = [&](int every) {
      ClosedLoop loop = tracking(law);
      loop.target.velocity_mps = Vector3(0.05, 0.02, -0.03);
      loop.target.tracks_orientation = true;
      loop.target.angular_velocity_radps = Vector3(0.1, 0.2, -0.1);
      loop.add_sphere(Vector3(-0.1, 0.4, 0.9), Vector3(0, -0.1, 0));
      std::vector<double> seen;
      for (int i = 0; i < 100; ++i) {
        loop.sends_target = loop.sends_obstacles = i % every == 0;
        loop.cycle();
        for (const double velocity : loop.last.command.velocity_radps) seen.push_back(velocity);
        seen.push_back(loop.last.report.clearance_m);
        seen.push_back(loop.last.report.target_distance_m);
      }
      return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(seen.data(), static_cast<Eigen::Index>(seen.size())));
    };
    check_near_because(play(10), play(1), 1e-6, "%s", law);
  }
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(an_old_target_leads_to_hold_and_a_new_one_to_track),
      cmocka_unit_test(the_motion_of_an_old_target_does_not_change_how_the_arm_evades),
      cmocka_unit_test(old_obstacles_brake_and_grow),
      cmocka_unit_test(the_arm_does_not_start_on_old_obstacles),
      cmocka_unit_test(obstacles_received_in_the_future_are_not_farther_away),
      cmocka_unit_test(a_short_gap_of_arm_states_brakes_and_a_long_one_is_a_fault),
      cmocka_unit_test(an_arm_that_jumps_is_a_fault_and_continues_from_its_new_position),
      cmocka_unit_test(an_arm_whose_clock_runs_ahead_may_not_jump),
      cmocka_unit_test(a_silence_of_the_arm_counts_where_its_states_are_the_clock),
      cmocka_unit_test(after_a_pause_of_the_controller_commands_start_from_the_arms_position),
      cmocka_unit_test(a_foreign_command_counts_for_half_a_second),
      cmocka_unit_test(an_arm_whose_clock_stops_or_goes_back_is_a_fault),
      cmocka_unit_test(target_and_obstacles_are_extrapolated_to_the_current_cycle),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
