#include "firmware/control/command_stream.h"
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
JointLimits random_limits(Random& random, int joints) {
  JointLimits limits = limits_of(0, 0, 0, 0, joints);
  for (int i = 0; i < joints; ++i) {
    const bool endless = random.chance(0.1);
    limits.lower_rad[i] = endless ? -kInfinity : random.uniform(-3, 0);
    limits.upper_rad[i] = endless ? kInfinity : limits.lower_rad[i] + random.uniform(0.02, 5);
    limits.velocity_radps[i] = random.uniform(0.1, 4);
    limits.acceleration_radps2[i] = std::pow(10.0, random.uniform(-1, 2));
  }
  return limits;
}

/// Nominal velocities that no sane law computes: far too fast, reversing at once, resting for a while.
JointVector extreme_nominal(Random& random, int joints) {
  JointVector nominal_radps = random.joints(joints, -1, 1) * std::pow(10.0, random.uniform(-2, 3));
  if (random.chance(0.2)) nominal_radps.setZero();
  if (random.chance(0.2)) nominal_radps.setConstant(random.chance(0.5) ? 1e6 : -1e6);
  return nominal_radps;
}

/// Limits that stop every motion would pass the walk above.
/// A joint between its commanded and its measured position can stop before its limits from either.
void a_random_walk_of_extreme_nominal_velocities_never_leaves_the_limits(void**) {
  Random random(2);
  for (int walk = 0; walk < 40; ++walk) {
    const int joints = 6 + random.index(5);
    const JointLimits limits = random_limits(random, joints);
    JointVector q_rad(joints), qd_radps = JointVector::Zero(joints);
    for (int i = 0; i < joints; ++i)
      q_rad[i] = random.uniform(std::max(-3.0, limits.lower_rad[i]), std::min(3.0, limits.upper_rad[i]));
    JointVector nominal_radps = extreme_nominal(random, joints);
    for (int cycle = 0; cycle < 3000; ++cycle) {
      if (random.chance(0.1)) nominal_radps = extreme_nominal(random, joints);
      const VelocityRange range = velocity_range(limits, q_rad, q_rad, qd_radps, kPeriod_s);
      check((range.lower_radps.array() <= range.upper_radps.array()).all(), "walk %d, cycle %d: empty", walk, cycle);
      JointVector next = nominal_radps;
      apply_limits(limits, range, qd_radps, kPeriod_s, next);
      q_rad += kPeriod_s * next;
      for (int i = 0; i < joints; ++i) {
        check(q_rad[i] >= limits.lower_rad[i] - 1e-9 && q_rad[i] <= limits.upper_rad[i] + 1e-9,
              "walk %d, cycle %d, joint %d: at %.12f", walk, cycle, i, q_rad[i]);
        check(std::abs(next[i]) <= limits.velocity_radps[i] + 1e-9, "walk %d, cycle %d, joint %d: %g rad/s", walk,
              cycle, i, next[i]);
        check(std::abs(next[i] - qd_radps[i]) <= limits.acceleration_radps2[i] * kPeriod_s + 1e-9,
              "walk %d, cycle %d, joint %d: %g rad/s at once", walk, cycle, i, next[i] - qd_radps[i]);
      }
      qd_radps = next;
    }
  }
}

void a_joint_reaches_its_goal_nearly_as_fast_as_the_limits_allow(void**) {
  const JointLimits limits = limits_of(-1, 1, 2, 10);
  JointVector q_rad = JointVector::Zero(7), qd_radps = JointVector::Zero(7);
  int cycles = 0;
  for (; q_rad[0] < 0.999 && cycles < 1000; ++cycles) {
    JointVector next = JointVector::Constant(7, 2.0);
    apply_limits(limits, velocity_range(limits, q_rad, q_rad, qd_radps, kPeriod_s), qd_radps, kPeriod_s, next);
    q_rad += kPeriod_s * next;
    qd_radps = next;
  }
  // Accelerating 0.2 s and braking 0.2 s over 0.2 m each, 0.6 m between at 2 rad/s: 0.7 s.
  check(cycles <= 80, "%d cycles", cycles);
  for (int i = 0; i < 200; ++i) {
    JointVector next = JointVector::Constant(7, 2.0);
    apply_limits(limits, velocity_range(limits, q_rad, q_rad, qd_radps, kPeriod_s), qd_radps, kPeriod_s, next);
    q_rad += kPeriod_s * next;
    qd_radps = next;
  }
  check_near(q_rad, JointVector::Constant(7, 1.0), 1e-3);
  check(qd_radps.maxCoeff() < 1e-2, "%g rad/s at the limit", qd_radps.maxCoeff());
}

void a_nominal_velocity_beyond_the_limits_is_scaled_and_keeps_its_direction(void**) {
  Random random(3);
  for (int trial = 0; trial < 500; ++trial) {
    JointLimits limits = limits_of(-kInfinity, kInfinity, 2, 1e9);
    limits.velocity_radps = random.joints(7, 0.5, 3);
    const JointVector nominal_radps = random.joints(7, -1, 1) * std::pow(10.0, random.uniform(-1, 2));
    const JointVector rest = JointVector::Zero(7);
    JointVector given = nominal_radps;
    const int limiting =
        apply_limits(limits, velocity_range(limits, rest, rest, rest, kPeriod_s), rest, kPeriod_s, given);
    const double excess = nominal_radps.cwiseAbs().cwiseQuotient(limits.velocity_radps).maxCoeff();
    check_near_because(given, JointVector(nominal_radps / std::max(1.0, excess)), 1e-12, "trial %d", trial);
    check(limiting == (excess > 1.0 ? kLimitingVelocity : kLimitingNothing), "trial %d: %d", trial, limiting);
  }
}

void the_limits_that_acted_are_reported(void**) {
  const JointLimits limits = limits_of(-1, 1, 2, 10);
  const JointVector middle = JointVector::Zero(7), edge = JointVector::Constant(7, 0.9999);
  const auto acted = [&](const JointVector& q_rad, double last, double nominal) {
    const JointVector before = JointVector::Constant(7, last);
    JointVector velocity = JointVector::Constant(7, nominal);
    return apply_limits(limits, velocity_range(limits, q_rad, q_rad, before, kPeriod_s), before, kPeriod_s, velocity);
  };
  assert_int_equal(acted(middle, 1.0, 1.05), kLimitingNothing);
  assert_int_equal(acted(middle, 1.0, 1.2), kLimitingAcceleration);
  assert_int_equal(acted(middle, 2.0, 2.5), kLimitingVelocity);
  assert_int_equal(acted(middle, 0.0, 2.5), kLimitingVelocity | kLimitingAcceleration);
  assert_int_equal(acted(edge, 0.0, 0.09), kLimitingPosition);
}

void a_joint_outside_its_position_limits_returns(void**) {
  Random random(4);
  for (int trial = 0; trial < 50; ++trial) {
    const JointLimits limits = limits_of(-1, 1, random.uniform(0.5, 3), random.uniform(1, 50));
    JointVector q_rad = random.joints(7, -2, 2), qd_radps = JointVector::Zero(7);
    JointVector nominal_radps = random.joints(7, -5, 5);
    for (int cycle = 0; cycle < 1000; ++cycle) {
      const JointVector before = q_rad;
      JointVector next = nominal_radps;
      apply_limits(limits, velocity_range(limits, q_rad, q_rad, qd_radps, kPeriod_s), qd_radps, kPeriod_s, next);
      check(((next - qd_radps).cwiseAbs().array() <= limits.acceleration_radps2.array() * kPeriod_s + 1e-9).all(),
            "trial %d, cycle %d", trial, cycle);
      q_rad += kPeriod_s * next;
      qd_radps = next;
      for (int i = 0; i < 7; ++i)
        check(std::abs(q_rad[i]) <= std::max(1.0, std::abs(before[i])) + 1e-9,
              "trial %d, cycle %d, joint %d moves farther out", trial, cycle, i);
    }
    check(q_rad.cwiseAbs().maxCoeff() <= 1.0 + 1e-3, "trial %d: still at %g", trial, q_rad.cwiseAbs().maxCoeff());
  }
}

void brake_reaches_exactly_zero_and_stays(void**) {
  Random random(5);
  for (int trial = 0; trial < 300; ++trial) {
    const JointLimits limits = random_limits(random, 7);
    JointVector qd_radps = random.joints(7, -3, 3);
    const double longest = qd_radps.cwiseAbs().cwiseQuotient(limits.acceleration_radps2).maxCoeff() / kPeriod_s;
    for (int cycle = 0; cycle < static_cast<int>(std::ceil(longest)) + 1; ++cycle) {
      const JointVector next = brake(limits, qd_radps, kPeriod_s);
      for (int i = 0; i < 7; ++i) {
        const double change = std::abs(next[i] - qd_radps[i]), step = limits.acceleration_radps2[i] * kPeriod_s;
        check_near_because(change, std::min(step, std::abs(qd_radps[i])), 1e-12, "trial %d, cycle %d", trial, cycle);
        check(next[i] * qd_radps[i] >= 0.0, "trial %d, cycle %d: past zero", trial, cycle);
      }
      qd_radps = next;
    }
    check(qd_radps.isZero(0.0), "trial %d: %g rad/s left", trial, qd_radps.cwiseAbs().maxCoeff());
  }
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_random_walk_of_extreme_nominal_velocities_never_leaves_the_limits),
      cmocka_unit_test(a_joint_reaches_its_goal_nearly_as_fast_as_the_limits_allow),
      cmocka_unit_test(a_nominal_velocity_beyond_the_limits_is_scaled_and_keeps_its_direction),
      cmocka_unit_test(the_limits_that_acted_are_reported),
      cmocka_unit_test(a_joint_outside_its_position_limits_returns),
      cmocka_unit_test(brake_reaches_exactly_zero_and_stays),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
