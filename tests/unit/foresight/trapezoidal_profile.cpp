#include "firmware/foresight/trapezoidal_profile.h"

#include "tests/support/check.h"
#include "tests/support/lwa3.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::lwa3;
using test::Random;

namespace {

constexpr double kShare = 0.9, kStart_s = 3.0;

JointVector random_velocity(Random& random) {
  JointVector qd_radps = lwa3().limits.velocity_radps;
  for (double& speed_radps : qd_radps) speed_radps *= random.uniform(-1.0, 1.0);
  return qd_radps;
}

/// The time to rest at 0 of a joint that follows the switching curve of the time-optimal double integrator: toward the
/// goal as fast as the limit of velocity permits, until it can just stop there.
double switching_curve_s(double q_rad, double qd_radps, double most_radps, double most_radps2) {
  constexpr double kStep_s = 1e-5;
  double at_s = 0.0;
  for (; at_s < 20.0; at_s += kStep_s) {
    const double stop_rad = q_rad + 0.5 * qd_radps * std::abs(qd_radps) / most_radps2;
    const double wanted_radps = stop_rad > 0.0 ? -most_radps : most_radps;
    const double change_radps = std::clamp(wanted_radps - qd_radps, -most_radps2 * kStep_s, most_radps2 * kStep_s);
    q_rad += kStep_s * (qd_radps + 0.5 * change_radps);
    qd_radps += change_radps;
    if (std::abs(q_rad) < 1e-4 && std::abs(qd_radps) < 1e-2) return at_s;
  }
  return at_s;
}

void a_profile_ends_at_rest_at_its_goal_within_the_limits_and_never_jumps(void**) {
  Random random(1);
  int cruising = 0, fast = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    const double way_rad = random.uniform(-3, 3), most_radps = random.uniform(0.5, 2),
                 most_radps2 = random.uniform(1, 15);
    const double from_radps = random.uniform(-2, 2), fastest_radps = std::max(most_radps, std::abs(from_radps));
    const TrapezoidalProfile profile(way_rad, from_radps, most_radps, most_radps2);
    check_near_because(profile.position_rad(0.0), 0.0, 1e-12, "trial %d", trial);
    check_near_because(profile.velocity_radps(0.0), from_radps, 1e-12, "trial %d", trial);
    check_near_because(profile.position_rad(profile.end_s()), way_rad, 1e-12, "trial %d", trial);
    check_near_because(profile.velocity_radps(profile.end_s()), 0.0, 1e-12, "trial %d", trial);
    const double dt_s = profile.end_s() / 1000.0;
    for (double at_s = 0.0; at_s < profile.end_s(); at_s += dt_s) {
      const double before_radps = profile.velocity_radps(at_s), after_radps = profile.velocity_radps(at_s + dt_s);
      check(std::abs(before_radps) <= fastest_radps + 1e-9, "trial %d, %g s: %g rad/s", trial, at_s, before_radps);
      check(std::abs(after_radps - before_radps) <= most_radps2 * dt_s + 1e-9, "trial %d, %g s", trial, at_s);
      const double moved_rad = profile.position_rad(at_s + dt_s) - profile.position_rad(at_s);
      check_near_because(moved_rad, 0.5 * (before_radps + after_radps) * dt_s, most_radps2 * dt_s * dt_s + 1e-9,
                         "trial %d, %g s", trial, at_s);
    }
    cruising += profile.cruise_ends_s() > profile.cruise_begins_s();
    fast += std::abs(from_radps) > most_radps;
  }
  check(cruising > 100 && cruising < 900 && fast > 100, "%d cruise, %d begin too fast", cruising, fast);
}

void a_profile_takes_as_long_as_the_switching_curve(void**) {
  Random random(2);
  for (int trial = 0; trial < 60; ++trial) {
    const double way_rad = random.uniform(-2, 2), most_radps = random.uniform(0.5, 2),
                 most_radps2 = random.uniform(2, 15);
    const double from_radps = random.uniform(-1, 1) * most_radps;
    const TrapezoidalProfile profile(way_rad, from_radps, most_radps, most_radps2);
    check_near_because(profile.end_s(), switching_curve_s(-way_rad, from_radps, most_radps, most_radps2), 0.01,
                       "trial %d", trial);
  }
}

/// But for knots that are less than 0.1 ms apart, which are one.
void every_joint_of_a_guide_follows_its_own_profile(void**) {
  const JointLimits& limits = lwa3().limits;
  Random random(3);
  for (int trial = 0; trial < 200; ++trial) {
    const JointVector from_rad = random.configuration(lwa3()), to_rad = random.configuration(lwa3());
    const JointVector from_radps = random_velocity(random);
    Guide guide;
    guide.add(kStart_s, from_rad, from_radps);
    append_fastest(limits, kShare, to_rad, guide);
    for (int k = 1; k < guide.knots; ++k) check(guide.time_s[k] > guide.time_s[k - 1], "trial %d, knot %d", trial, k);
    check(guide.position_rad[guide.knots - 1] == to_rad, "trial %d", trial);
    check(guide.velocity_radps[guide.knots - 1].isZero(0.0), "trial %d", trial);
    double latest_s = 0.0;
    for (Eigen::Index i = 0; i < to_rad.size(); ++i) {
      const TrapezoidalProfile profile(to_rad[i] - from_rad[i], from_radps[i], kShare * limits.velocity_radps[i],
                                       kShare * limits.acceleration_radps2[i]);
      latest_s = std::max(latest_s, profile.end_s());
      for (double after_s = 0.0; after_s < profile.end_s(); after_s += 0.013) {
        const GuidePoint point = point_of(guide, kStart_s + after_s);
        check_near_because(point.position_rad[i], from_rad[i] + profile.position_rad(after_s), 2e-5, "trial %d", trial);
        check_near_because(point.velocity_radps[i], profile.velocity_radps(after_s), 2e-3, "trial %d", trial);
      }
    }
    check_near_because(guide.end_s(), kStart_s + latest_s, 1e-9, "trial %d", trial);
  }
}

void a_way_to_the_present_position_is_a_guide_as_well(void**) {
  Guide guide;
  guide.add(kStart_s, JointVector::Zero(7));
  append_fastest(lwa3().limits, kShare, JointVector::Zero(7), guide);
  check(guide.knots == 2 && guide.time_s[1] > kStart_s, "%d knots", guide.knots);
  check(point_of(guide, kStart_s + 1e-5).position_rad.isZero(0.0), "moved");
}

void the_longest_arm_has_room_for_its_knots(void**) {
  Random random(4);
  JointLimits limits;
  limits.velocity_radps = JointVector::Constant(kMaxJoints, 1.0);
  limits.acceleration_radps2 = JointVector::Constant(kMaxJoints, 4.0);
  int most = 0;
  for (int trial = 0; trial < 100; ++trial) {
    JointVector to_rad = limits.velocity_radps, from_radps = limits.velocity_radps;
    for (double& q_rad : to_rad) q_rad = random.uniform(-3, 3);
    for (double& qd_radps : from_radps) qd_radps = random.uniform(-1, 1);
    Guide guide;
    guide.add(kStart_s, JointVector::Zero(kMaxJoints), from_radps);
    append_fastest(limits, kShare, to_rad, guide);
    most = std::max(most, guide.knots);
  }
  check(most > 25 && most <= kMaxKnots, "%d knots", most);
}

void a_stoppable_velocity_keeps_the_position_limits_on_the_way(void**) {
  const JointLimits& limits = lwa3().limits;
  Random random(5);
  int limited = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const JointVector from_rad = random.configuration(lwa3()), to_rad = random.configuration(lwa3());
    const JointVector from_radps = random_velocity(random);
    const JointVector stoppable = stoppable_radps(limits, kShare, from_rad, from_radps);
    limited += stoppable != from_radps;
    for (Eigen::Index i = 0; i < to_rad.size(); ++i) {
      check(stoppable[i] * from_radps[i] >= 0.0 && std::abs(stoppable[i]) <= std::abs(from_radps[i]), "trial %d",
            trial);
      const double stop_rad =
          from_rad[i] + 0.5 * from_radps[i] * std::abs(from_radps[i]) / (kShare * limits.acceleration_radps2[i]);
      const bool stops = stop_rad > limits.lower_rad[i] + 1e-9 && stop_rad < limits.upper_rad[i] - 1e-9;
      check(!stops || stoppable[i] == from_radps[i], "trial %d: joint %d is slowed", trial, static_cast<int>(i));
    }
    Guide guide;
    guide.add(kStart_s, from_rad, stoppable);
    append_fastest(limits, kShare, to_rad, guide);
    for (double at_s = kStart_s; at_s < guide.end_s(); at_s += 2e-3) {
      const JointVector q_rad = point_of(guide, at_s).position_rad;
      const double beyond_rad = std::max((q_rad - limits.upper_rad).maxCoeff(), (limits.lower_rad - q_rad).maxCoeff());
      check(beyond_rad < 1e-6, "trial %d: %g rad beyond", trial, beyond_rad);
    }
  }
  check(limited > 20 && limited < 480, "%d limited", limited);
}

void a_joint_beyond_its_limit_may_start_only_back(void**) {
  const JointLimits& limits = lwa3().limits;
  JointVector q_rad = JointVector::Zero(7);
  q_rad[1] = limits.upper_rad[1] + 0.05;
  const JointVector out = JointVector::Constant(7, 0.5), back = -out;
  check(stoppable_radps(limits, kShare, q_rad, out)[1] == 0.0, "moves on");
  check(stoppable_radps(limits, kShare, q_rad, back)[1] == -0.5, "does not return");
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_profile_ends_at_rest_at_its_goal_within_the_limits_and_never_jumps),
      cmocka_unit_test(a_profile_takes_as_long_as_the_switching_curve),
      cmocka_unit_test(every_joint_of_a_guide_follows_its_own_profile),
      cmocka_unit_test(a_way_to_the_present_position_is_a_guide_as_well),
      cmocka_unit_test(the_longest_arm_has_room_for_its_knots),
      cmocka_unit_test(a_stoppable_velocity_keeps_the_position_limits_on_the_way),
      cmocka_unit_test(a_joint_beyond_its_limit_may_start_only_back),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
