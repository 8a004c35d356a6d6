#include "host/sim/plant.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "tests/support/check.h"

using namespace sidestep::sim;

namespace {

JointVector both(double first, double second) {
  JointVector v(2);
  v << first, second;
  return v;
}

PlantSpec servo(double lag_s, double latency_s, double velocity_radps, double acceleration_radps2) {
  return {PlantSpec::Kind::kServo, lag_s, latency_s, both(velocity_radps, velocity_radps),
          both(acceleration_radps2, acceleration_radps2)};
}

void a_plant_stays_at_rest_without_commands(void**) {
  for (const PlantSpec& spec : {PlantSpec{}, servo(0.03, 0.01, 2, 10)}) {
    Plant plant(spec, both(0.1, -0.2));
    plant.advance(1'000'000);
    check_near(plant.q_rad(), both(0.1, -0.2), 0);
    check_near(plant.qd_radps(), both(0, 0), 0);
  }
}

void an_ideal_plant_adds_exactly_velocity_times_period(void**) {
  Plant plant({}, both(0.1, -0.2));
  JointVector q_rad = both(0.1, -0.2);
  for (int k = 0; k < 500; ++k) {
    const JointVector qd_radps = both(std::sin(0.1 * k), std::cos(0.3 * k));
    check(plant.command(qd_radps), "refused");
    check_near(plant.qd_radps(), qd_radps, 0);
    plant.advance(10'000);
    q_rad += qd_radps * 0.01;
    check_near(plant.q_rad(), q_rad, 0);
    check_near(plant.qd_radps(), qd_radps, 0);
  }
}

void an_ideal_plant_stops_50_ms_after_the_last_command(void**) {
  Plant plant({}, both(0, 0));
  plant.command(both(1, -2));
  plant.advance(49'999);
  check_near(plant.qd_radps(), both(1, -2), 0);
  plant.advance(100'000);
  check_near(plant.qd_radps(), both(0, 0), 0);
  check_near(plant.q_rad(), both(0.05, -0.1), 1e-15);
  plant.command(both(1, 1));
  plant.advance(10'000);
  check_near(plant.q_rad(), both(0.06, -0.09), 1e-15);
}

void a_servo_reaches_63_percent_of_a_step_after_its_lag(void**) {
  Plant plant(servo(0.03, 0, 10, 1e6), both(0, 0));
  plant.command(both(1, -1));
  plant.advance(30'000);
  const double share = 1.0 - std::exp(-1.0);
  // The acceleration limit of 1e6 rad/s2 delays the step by 1 us.
  check_near(plant.qd_radps(), both(share, -share), 1e-4);
  check_near(plant.q_rad(), both(0.03 * (1 - share), -0.03 * (1 - share)), 1e-5);
}

void a_servo_follows_its_differential_equation(void**) {
  const double lag_s = 0.03, limit_radps2 = 10, dt_s = 1e-6;
  Plant plant(servo(lag_s, 0, 1.5, limit_radps2), both(0, 0));
  double q_rad = 0, qd_radps = 0;
  for (const double command_radps : {0.1, 2.0, -0.7, -0.69, 0.0}) {
    plant.command(both(command_radps, 0));
    const double demand_radps = std::clamp(command_radps, -1.5, 1.5);
    for (int i = 0; i < 40'000; ++i) {
      q_rad += qd_radps * dt_s;
      qd_radps += std::clamp((demand_radps - qd_radps) / lag_s, -limit_radps2, limit_radps2) * dt_s;
    }
    plant.advance(40'000);
    check_near(plant.qd_radps()[0], qd_radps, 1e-4);
    check_near(plant.q_rad()[0], q_rad, 1e-5);
  }
}

void the_motion_of_a_servo_does_not_depend_on_the_time_steps(void**) {
  Plant whole(servo(0.02, 0.013, 2, 10), both(0, 0)), cut = whole;
  for (const double command_radps : {1.0, -2.0, 0.5}) {
    whole.command(both(command_radps, 1));
    cut.command(both(command_radps, 1));
    whole.advance(90'000);  // longer than the watchdog time
    for (int i = 0; i < 90; ++i) cut.advance(1'000);
    check_near(whole.q_rad(), cut.q_rad(), 1e-13);
    check_near(whole.qd_radps(), cut.qd_radps(), 1e-13);
  }
}

void a_servo_stays_within_its_limits(void**) {
  Plant plant(servo(0.005, 0, 1.5, 10), both(0, 0));
  JointVector before = plant.qd_radps();
  for (int k = 0; k < 600; ++k) {
    plant.command(k < 300 ? both(9, -9) : both(-9, 9));
    plant.advance(2'000);
    check((plant.qd_radps() - before).cwiseAbs().maxCoeff() <= 10 * 0.002 + 1e-12, "step %d", k);
    check(plant.qd_radps().cwiseAbs().maxCoeff() <= 1.5 + 1e-12, "step %d", k);
    before = plant.qd_radps();
  }
  check_near(plant.qd_radps(), both(-1.5, 1.5), 1e-6);
}

void a_servo_without_lag_ramps_to_the_command(void**) {
  Plant plant(servo(0, 0, 2, 10), both(0, 0));
  plant.command(both(0.2, -0.1));
  plant.advance(40'000);
  check_near(plant.qd_radps(), both(0.2, -0.1), 1e-15);
  check_near(plant.q_rad(), both(0.2 * 0.02 / 2 + 0.2 * 0.02, -(0.1 * 0.01 / 2 + 0.1 * 0.03)), 1e-15);
}

void commands_take_effect_in_order_after_the_latency(void**) {
  Plant plant(servo(0, 0.025, 10, 1e6), both(0, 0));
  plant.command(both(1, 0));
  plant.advance(10'000);
  plant.command(both(2, 0));
  plant.advance(14'999);
  check_near(plant.qd_radps()[0], 0, 0);
  plant.advance(10'000);
  check_near(plant.qd_radps()[0], 1, 0);
  plant.advance(10'000);
  check_near(plant.qd_radps()[0], 2, 0);
}

void a_servo_slows_down_50_ms_after_the_last_command_took_effect(void**) {
  Plant plant(servo(0, 0.02, 2, 10), both(0, 0));
  plant.command(both(0.2, 0));
  plant.advance(70'000);
  check_near(plant.qd_radps()[0], 0.2, 1e-15);
  plant.advance(10'000);
  check_near(plant.qd_radps()[0], 0.1, 1e-12);
  plant.advance(10'000);
  check_near(plant.qd_radps()[0], 0, 1e-12);
}

void commands_of_wrong_size_or_implausible_value_are_refused_and_counted(void**) {
  Plant plant({}, both(0, 0));
  plant.command(both(0.5, 0.5));
  plant.advance(10'000);
  const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
  check(!plant.command(both(nan, 0)), "NaN accepted");
  check(!plant.command(both(0, -infinity)), "infinity accepted");
  check(!plant.command(both(0, 1e300)), "1e300 accepted");
  check(!plant.command(Eigen::VectorXd::Zero(1)), "one value accepted");
  check(!plant.command(Eigen::VectorXd::Zero(3)), "three values accepted");
  check(!plant.command(Eigen::VectorXd::Zero(0)), "no value accepted");
  check(!plant.command(Eigen::VectorXd::Zero(1000)), "a thousand values accepted");
  assert_int_equal(plant.refused(), 7);
  check_near(plant.qd_radps(), both(0.5, 0.5), 0);
  check_near(plant.last_command_radps(), both(0.5, 0.5), 0);
  plant.advance(100'000);
  check_near(plant.q_rad(), both(0.025, 0.025), 1e-15);
}

void the_last_command_of_a_flood_takes_effect(void**) {
  Plant plant(servo(0, 0.02, 10, 1e6), both(0, 0));
  for (int i = 0; i < 100'000; ++i) plant.command(both(1, 0));
  plant.command(both(3, 0));
  plant.advance(21'000);
  check_near(plant.qd_radps()[0], 3, 1e-12);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_plant_stays_at_rest_without_commands),
      cmocka_unit_test(an_ideal_plant_adds_exactly_velocity_times_period),
      cmocka_unit_test(an_ideal_plant_stops_50_ms_after_the_last_command),
      cmocka_unit_test(a_servo_reaches_63_percent_of_a_step_after_its_lag),
      cmocka_unit_test(a_servo_follows_its_differential_equation),
      cmocka_unit_test(the_motion_of_a_servo_does_not_depend_on_the_time_steps),
      cmocka_unit_test(a_servo_stays_within_its_limits),
      cmocka_unit_test(a_servo_without_lag_ramps_to_the_command),
      cmocka_unit_test(commands_take_effect_in_order_after_the_latency),
      cmocka_unit_test(a_servo_slows_down_50_ms_after_the_last_command_took_effect),
      cmocka_unit_test(commands_of_wrong_size_or_implausible_value_are_refused_and_counted),
      cmocka_unit_test(the_last_command_of_a_flood_takes_effect),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
