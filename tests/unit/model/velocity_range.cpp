#include "firmware/model/velocity_range.h"

#include "tests/support/check.h"
#include "tests/support/limits.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::limits_of;
using test::Random;

namespace {

constexpr double kPeriod_s = 0.01;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Limits that differ widely from joint to joint.
/// Nominal velocities that no sane law computes: far too fast, reversing at once, resting for a while.
/// Limits that stop every motion would pass the walk above.
/// A joint between its commanded and its measured position can stop before its limits from either.
void braking_from_the_stopping_velocity_stops_within_the_gap(void**) {
  // v T + v^2 / 2a = gap with a = 10, T = 0.01, v = 1: 0.01 + 0.05.
  check_near(stopping_velocity(0.06, 10.0, 0.01), 1.0, 1e-12);
  check_near(stopping_velocity(-0.06, 10.0, 0.01), -1.0, 1e-12);
  check_near(stopping_velocity(0.0, 10.0, 0.01), 0.0, 0);
  check_near(stopping_velocity(kInfinity, 10.0, 0.01), kInfinity, 0);
  Random random(1);
  for (int trial = 0; trial < 300; ++trial) {
    const double gap = std::pow(10.0, random.uniform(-6, 1)), a = random.uniform(0.1, 50),
                 period_s = random.uniform(0.001, 0.05);
    double v = stopping_velocity(gap, a, period_s), travel = 0.0;
    const double first = v;
    for (; v > 0; v = std::max(0.0, v - a * period_s)) travel += v * period_s;
    check(travel <= gap + 1e-12, "trial %d: %g of %g", trial, travel, gap);
    check(travel >= gap - first * period_s - 1e-12, "trial %d: stops %g short of %g", trial, gap - travel, gap);
  }
}

void a_joint_too_fast_to_stop_brakes_at_its_acceleration_limit(void**) {
  const JointLimits limits = limits_of(-1, 1, 2, 10);
  const JointVector q_rad = JointVector::Constant(7, 0.99), qd_radps = JointVector::Constant(7, 1.9);
  const VelocityRange range = velocity_range(limits, q_rad, q_rad, qd_radps, kPeriod_s);
  check_near(range.lower_radps, JointVector::Constant(7, 1.8), 1e-12);
  check_near(range.upper_radps, JointVector::Constant(7, 1.8), 1e-12);
}

void the_position_nearer_to_each_limit_counts(void**) {
  const JointLimits limits = limits_of(-1, 1, 2, 100);
  const JointVector rest = JointVector::Zero(7), low = JointVector::Constant(7, -0.95),
                    high = JointVector::Constant(7, 0.97);
  const VelocityRange range = velocity_range(limits, low, high, rest, kPeriod_s);
  check_near(range.lower_radps, JointVector::Constant(7, -std::min(1.0, stopping_velocity(0.05, 100, kPeriod_s))),
             1e-12);
  check_near(range.upper_radps, JointVector::Constant(7, std::min(1.0, stopping_velocity(0.03, 100, kPeriod_s))),
             1e-12);
}
}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(braking_from_the_stopping_velocity_stops_within_the_gap),
      cmocka_unit_test(a_joint_too_fast_to_stop_brakes_at_its_acceleration_limit),
      cmocka_unit_test(the_position_nearer_to_each_limit_counts),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
