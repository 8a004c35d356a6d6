#include "firmware/control/input_monitor.h"

#include <memory>

#include "tests/support/check.h"
#include "tests/support/closed_loop.h"
#include "tests/support/lwa3.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::home_rad;

namespace {

constexpr double kPeriod_s = 0.01;

/// A monitor with inputs that arrive every period until a test changes them.
struct Monitored {
  Model model = test::lwa3_model("sidestep");
  ArmState arm{0, home_rad(), JointVector::Zero(7)};
  Target target;
  std::unique_ptr<ObstacleSet> obstacles = std::make_unique<ObstacleSet>();
  Inputs inputs;
  ArmMonitor monitor;
  double now_s = 100.0;

  Monitored() { run(1.0); }

  MonitorResult cycle(double elapsed_s = kPeriod_s, bool new_arm_state = true) {
    now_s += elapsed_s;
    if (new_arm_state) {
      arm.utime = std::llround(now_s * 1e6);
      inputs.arm = {&arm, now_s, inputs.arm.count + 1};
    }
    inputs.target = {&target, now_s, inputs.target.count + 1};
    inputs.obstacles = {obstacles.get(), now_s, inputs.obstacles.count + 1};
    return monitor_inputs(model, inputs, now_s, monitor);
  }
  /// A cycle without new messages.
  MonitorResult silent_cycle(double elapsed_s) {
    now_s += elapsed_s;
    return monitor_inputs(model, inputs, now_s, monitor);
  }
  void run(double duration_s) {
    for (int i = 0; i < duration_s / kPeriod_s; ++i) cycle();
  }
};

void fresh_inputs_are_reported_as_fresh_and_consistent(void**) {
  Monitored m;
  const MonitorResult result = m.cycle();
  const InputStatus& s = result.status;
  assert_true(s.arm_known && s.arm_fresh && s.arm_consistent && s.obstacles_known && s.obstacles_fresh);
  assert_true(s.target_known && s.target_fresh);
  assert_false(s.arm_lost || s.arm_starting || s.arm_inconsistent || s.late || s.stop || s.foreign_command);
  assert_true(result.continuity.arm_follows);
  assert_false(result.continuity.cycles_paused || result.continuity.clock_went_back);
}

/// Each input times out at its own age; the cycles go on at one per period.
void every_input_times_out_at_its_configured_age(void**) {
  Monitored m;
  const Timeouts& timeouts = m.model.settings.timeouts;
  for (int i = 1; i <= 40; ++i) {
    const InputStatus s = m.silent_cycle(kPeriod_s).status;
    const double age_s = i * kPeriod_s;
    const auto expect = [&](bool fresh, double timeout_s, const char* name) {
      if (std::abs(age_s - timeout_s) < 1e-6) return;  // equal but for rounding
      check(fresh == (age_s < timeout_s), "%s at age %g s", name, age_s);
    };
    expect(s.arm_fresh, timeouts.arm_state_s, "arm state");
    expect(!s.arm_lost, timeouts.arm_state_lost_s, "lost arm state");
    expect(s.obstacles_fresh, timeouts.obstacles_s, "obstacles");
    expect(s.target_fresh, timeouts.target_s, "target");
  }
}

/// The largest step is the velocity limit times the elapsed time plus one period, plus 1 mrad.
void a_joint_step_beyond_the_velocity_limit_is_an_outlier(void**) {
  for (int joint = 0; joint < 7; ++joint) {
    for (const double sign : {-1.0, 1.0}) {
      Monitored m;
      const double largest_rad = m.model.arm.limits.velocity_radps[joint] * 2.0 * kPeriod_s + 1e-3;
      m.arm.position_rad[joint] += sign * (largest_rad - 1e-6);
      assert_true(m.cycle().status.arm_consistent);
      const JointVector accepted_rad = m.arm.position_rad;
      m.arm.position_rad[joint] += sign * (largest_rad + 1e-6);
      assert_false(m.cycle().status.arm_consistent);
      check_near(m.monitor.accepted.state.position_rad, accepted_rad, 0);
    }
  }
}

/// Within reach of the last state that was accepted before it.
void the_state_after_a_wrong_one_within_reach_is_no_outlier(void**) {
  for (const double rate_radps : {0.0, 1.0, 2.0}) {
    for (const double wrong_rad : {-0.03, -0.01, 0.01, 0.03}) {
      Monitored m;
      for (int i = 0; i < 20; ++i) {
        m.arm.position_rad[1] += rate_radps * kPeriod_s;
        m.cycle();
      }
      for (const double error_rad : {wrong_rad, -wrong_rad, 0.0}) {  // adds up to 0
        m.arm.position_rad[1] += rate_radps * kPeriod_s + error_rad;
        m.cycle();
      }
      check_near(m.monitor.accepted.state.position_rad, m.arm.position_rad, 0);
    }
  }
}

/// The jump is accepted when the outliers last as long as a lost arm, and reported in that cycle.
void an_arm_that_jumped_is_consistent_half_a_second_after_it_is_accepted(void**) {
  Monitored m;
  const Timeouts& timeouts = m.model.settings.timeouts;
  m.arm.position_rad[2] += 1.0;
  int cycles = 0, inconsistent_at = 0;
  for (bool consistent = false; !consistent && cycles < 1000; ++cycles) {
    const MonitorResult result = m.cycle();
    assert_true(result.continuity.arm_follows);
    consistent = result.status.arm_consistent;
    if (result.status.arm_inconsistent) inconsistent_at = cycles + 1;
  }
  check_near(inconsistent_at * kPeriod_s, timeouts.arm_state_lost_s, 1.01 * kPeriod_s);
  check_near((cycles - inconsistent_at) * kPeriod_s, timeouts.consistent_s, 1e-9);
}

void a_utime_that_does_not_advance_is_inconsistent(void**) {
  Monitored m;
  m.now_s += kPeriod_s;
  m.inputs.arm = {&m.arm, m.now_s, m.inputs.arm.count + 1};  // a new state with the old utime
  assert_true(monitor_inputs(m.model, m.inputs, m.now_s, m.monitor).status.arm_inconsistent);
}

void three_skipped_cycles_in_a_row_are_late(void**) {
  Monitored m;
  for (const bool separated : {true, false}) {
    bool late = false;
    for (int i = 0; i < 3; ++i) {
      m.inputs.skipped_cycles = 1;
      late = m.cycle().status.late;
      m.inputs.skipped_cycles = 0;
      if (separated) m.cycle();
    }
    check(late == !separated, "separated: %d", separated);
    m.cycle();
  }
}

void a_pause_of_the_cycles_longer_than_50_ms_is_reported_with_its_end(void**) {
  Monitored m;
  const double last_s = m.now_s;
  assert_false(m.cycle(0.049).continuity.cycles_paused);
  const MonitorResult result = m.cycle(0.051);
  assert_true(result.continuity.cycles_paused);
  check_near(result.continuity.arm_waited_until_s, last_s + 0.049 + 0.05, 1e-9);
}

void a_clock_that_goes_back_is_reported(void**) {
  Monitored m;
  assert_true(m.cycle(-5.0).continuity.clock_went_back);
  assert_false(m.cycle().continuity.clock_went_back);
}

void a_foreign_command_counts_for_half_a_second(void**) {
  Monitored m;
  m.inputs.foreign_command_s = m.now_s;
  assert_true(m.cycle().status.foreign_command);
  m.run(m.model.settings.timeouts.consistent_s - 3 * kPeriod_s);
  assert_true(m.cycle().status.foreign_command);
  m.run(2 * kPeriod_s);
  assert_false(m.cycle().status.foreign_command);
}

void a_new_driver_starts_the_start_guard(void**) {
  Monitored m;
  m.model.settings.start_guard_s = 0.25;
  m.run(0.5);
  assert_false(m.cycle().status.arm_starting);
  m.now_s += 10.0;  // no state for longer than the guard
  int cycles = 0;
  while (m.cycle().status.arm_starting && cycles < 1000) ++cycles;
  check_near(cycles * kPeriod_s, 0.25, 1.01 * kPeriod_s);
}

void the_rate_is_the_difference_quotient_of_the_positions(void**) {
  test::Random random(1);
  Monitored m;
  for (int i = 0; i < 100; ++i) {
    const JointVector qd_radps = random.joints(7, -1.5, 1.5);
    m.arm.position_rad += qd_radps * kPeriod_s;
    m.cycle();
    check_near(m.monitor.rate_radps, qd_radps, 1e-6);
  }
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(fresh_inputs_are_reported_as_fresh_and_consistent),
      cmocka_unit_test(every_input_times_out_at_its_configured_age),
      cmocka_unit_test(a_joint_step_beyond_the_velocity_limit_is_an_outlier),
      cmocka_unit_test(the_state_after_a_wrong_one_within_reach_is_no_outlier),
      cmocka_unit_test(an_arm_that_jumped_is_consistent_half_a_second_after_it_is_accepted),
      cmocka_unit_test(a_utime_that_does_not_advance_is_inconsistent),
      cmocka_unit_test(three_skipped_cycles_in_a_row_are_late),
      cmocka_unit_test(a_pause_of_the_cycles_longer_than_50_ms_is_reported_with_its_end),
      cmocka_unit_test(a_clock_that_goes_back_is_reported),
      cmocka_unit_test(a_foreign_command_counts_for_half_a_second),
      cmocka_unit_test(a_new_driver_starts_the_start_guard),
      cmocka_unit_test(the_rate_is_the_difference_quotient_of_the_positions),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
