#include "firmware/foresight/segment_to_rest.h"

#include "tests/support/check.h"
#include "tests/support/lwa3.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::lwa3;
using test::Random;

namespace {

constexpr double kShare = 0.9;

JointVector random_velocity(Random& random, double share) {
  JointVector qd_radps = lwa3().limits.velocity_radps;
  for (double& speed_radps : qd_radps) speed_radps *= random.uniform(-share, share);
  return qd_radps;
}

Guide guide_of(const JointVector& from_rad, const JointVector& from_radps, const JointVector& to_rad,
               double duration_s) {
  Guide guide;
  guide.add(3.0, from_rad, from_radps);
  guide.add(3.0 + duration_s, to_rad);
  return guide;
}

/// Against the cubic of the guide in small steps.
void the_extremes_of_a_segment_are_those_of_the_guide(void**) {
  Random random(1);
  int turning = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const double q = random.uniform(-1, 1), to = random.uniform(-1, 1), qd = random.uniform(-2, 2);
    const double duration_s = random.uniform(0.2, 3.0);
    const SegmentToRest segment{to - q, qd, duration_s};
    const auto one = [](double value) { return JointVector(JointVector::Constant(1, value)); };
    const Guide guide = guide_of(one(q), one(qd), one(to), duration_s);
    double fastest = 0.0, steepest = 0.0, lowest = std::min(q, to), highest = std::max(q, to);
    constexpr int kSteps = 4000;
    const double dt_s = duration_s / kSteps;
    for (int k = 0; k < kSteps; ++k) {
      const GuidePoint now = point_of(guide, 3.0 + k * dt_s), next = point_of(guide, 3.0 + (k + 0.999) * dt_s);
      fastest = std::max(fastest, std::abs(now.velocity_radps[0]));
      steepest = std::max(steepest, std::abs(next.velocity_radps[0] - now.velocity_radps[0]) / (0.999 * dt_s));
      lowest = std::min(lowest, now.position_rad[0]);
      highest = std::max(highest, now.position_rad[0]);
    }
    check_near_because(segment.largest_velocity_radps(), fastest, 1e-3, "trial %d", trial);
    check_near_because(segment.largest_acceleration_radps2(), steepest, 1e-2 * (1.0 + steepest), "trial %d", trial);
    const double turns = q + segment.turning_rad();
    check_near_because(std::min({q, to, turns}), lowest, 1e-5, "trial %d", trial);
    check_near_because(std::max({q, to, turns}), highest, 1e-5, "trial %d", trial);
    turning += segment.turning_rad() != 0.0;
  }
  check(turning > 50 && turning < 250, "%d turn back", turning);
}

void a_segment_keeps_the_limits_and_a_shorter_one_does_not(void**) {
  const JointLimits& limits = lwa3().limits;
  Random random(2);
  const auto excess = [&](const JointVector& way_rad, const JointVector& from_radps, double duration_s) {
    double largest = 0.0;
    for (Eigen::Index i = 0; i < way_rad.size(); ++i) {
      const SegmentToRest segment{way_rad[i], from_radps[i], duration_s};
      const double fastest_radps = std::max(kShare * limits.velocity_radps[i], std::abs(from_radps[i]));
      largest = std::max({largest, segment.largest_velocity_radps() / fastest_radps,
                          segment.largest_acceleration_radps2() / (kShare * limits.acceleration_radps2[i])});
    }
    return largest;
  };
  for (int trial = 0; trial < 1000; ++trial) {
    const JointVector way_rad = random.configuration(lwa3()) - random.configuration(lwa3());
    const JointVector from_radps = random_velocity(random, trial % 10 == 0 ? 1.0 : 0.9);
    const double duration_s = duration_to_rest_s(limits, kShare, way_rad, from_radps);
    check(excess(way_rad, from_radps, duration_s) <= 1.0 + 1e-9, "trial %d: %g s", trial, duration_s);
    check(excess(way_rad, from_radps, duration_s / 1.1) > 1.0 - 1e-9, "trial %d: %g s is long", trial, duration_s);
  }
}

void an_arm_that_is_under_way_arrives_sooner_than_from_rest(void**) {
  const JointLimits& limits = lwa3().limits;
  Random random(3);
  for (int trial = 0; trial < 200; ++trial) {
    const JointVector way_rad = random.uniform(0.2, 2.0) * random_velocity(random, 1.0);
    const double rest_s = duration_to_rest_s(limits, kShare, way_rad, JointVector::Zero(7));
    const JointVector from_radps = way_rad / rest_s;
    const double moving_s = duration_to_rest_s(limits, kShare, way_rad, from_radps);
    check(moving_s < rest_s, "%g s, %g s from rest", moving_s, rest_s);
    check(duration_to_rest_s(limits, kShare, way_rad, -from_radps) > moving_s, "trial %d", trial);
  }
}

void a_joint_that_turns_beyond_its_limit_is_found(void**) {
  const JointLimits& limits = lwa3().limits;
  Random random(4);
  int beyond = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const JointVector from_rad = random.configuration(lwa3()), to_rad = random.configuration(lwa3());
    const JointVector from_radps = random_velocity(random, 1.0);
    const double duration_s = duration_to_rest_s(limits, kShare, to_rad - from_rad, from_radps);
    const Guide guide = guide_of(from_rad, from_radps, to_rad, duration_s);
    double worst_rad = -1.0;
    for (double after_s = 0.0; after_s < duration_s; after_s += 2e-3) {
      const JointVector q_rad = point_of(guide, 3.0 + after_s).position_rad;
      worst_rad = std::max({worst_rad, (q_rad - limits.upper_rad).maxCoeff(), (limits.lower_rad - q_rad).maxCoeff()});
    }
    if (std::abs(worst_rad) < 1e-4) continue;
    check(turns_within_limits(limits, guide) == (worst_rad < 0.0), "trial %d: %g rad beyond", trial, worst_rad);
    beyond += worst_rad > 0.0;
  }
  check(beyond > 20 && beyond < 480, "%d beyond", beyond);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(the_extremes_of_a_segment_are_those_of_the_guide),
      cmocka_unit_test(a_segment_keeps_the_limits_and_a_shorter_one_does_not),
      cmocka_unit_test(an_arm_that_is_under_way_arrives_sooner_than_from_rest),
      cmocka_unit_test(a_joint_that_turns_beyond_its_limit_is_found),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
