#include "firmware/control/types/guide.h"

#include "firmware/control/guided_law.h"
#include "firmware/control/sidestep_law.h"
#include "tests/support/check.h"
#include "tests/support/lwa3.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::lwa3;
using test::Random;

namespace {

Guide random_guide(Random& random, int knots) {
  Guide guide;
  guide.foresight_status = ForesightStatus::kGuided;
  double time_s = 1.0;
  for (int k = 0; k < knots; ++k) {
    guide.add(time_s, random.configuration(lwa3()));
    time_s += random.uniform(0.3, 2.0);
  }
  return guide;
}

/// The velocity is the slope of the position.
void check_slope(const Guide& guide, double at_s) {
  const double h_s = 1e-6;
  const JointVector slope =
      (point_of(guide, at_s + h_s).position_rad - point_of(guide, at_s - h_s).position_rad) / (2.0 * h_s);
  check_near_because(point_of(guide, at_s).velocity_radps, slope, 1e-4, "at %g s", at_s);
}

void a_guide_rests_in_its_knots_and_before_and_after(void**) {
  Random random(1);
  for (int trial = 0; trial < 50; ++trial) {
    const Guide guide = random_guide(random, 1 + trial % kMaxKnots);
    for (int k = 0; k < guide.knots; ++k) {
      const GuidePoint point = point_of(guide, guide.time_s[static_cast<size_t>(k)]);
      check_near(point.position_rad, guide.position_rad[static_cast<size_t>(k)], 1e-12);
      check_near(point.velocity_radps, JointVector::Zero(7), 1e-12);
    }
    check_near(point_of(guide, -5.0).position_rad, guide.position_rad[0], 0.0);
    check_near(point_of(guide, 1e6).position_rad, guide.position_rad[static_cast<size_t>(guide.knots - 1)], 0.0);
    check_near(point_of(guide, 1e6).velocity_radps, JointVector::Zero(7), 0.0);
  }
}

void the_velocity_of_a_guide_is_the_slope_of_its_position(void**) {
  Random random(2);
  for (int trial = 0; trial < 200; ++trial) {
    const Guide guide = random_guide(random, 3);
    check_slope(guide, random.uniform(0.9, guide.end_s() + 0.1));
  }
}

void a_guide_passes_its_knots_at_their_velocities(void**) {
  Random random(4);
  for (int trial = 0; trial < 100; ++trial) {
    Guide guide = random_guide(random, 4);
    for (size_t k : {1, 2}) guide.velocity_radps[k] = random.joints(7, -2.0, 2.0);
    const double h_s = 1e-7;
    for (size_t k = 0; k < 4; ++k) {
      for (const double at_s : {guide.time_s[k] - h_s, guide.time_s[k], guide.time_s[k] + h_s}) {
        check_near(point_of(guide, at_s).position_rad, guide.position_rad[k], 1e-6);
        check_near(point_of(guide, at_s).velocity_radps, guide.velocity_radps[k], 1e-4);
      }
    }
    check_slope(guide, random.uniform(0.9, guide.end_s() + 0.1));
  }
}

void a_guide_waits_for_an_arm_that_cannot_follow(void**) {
  Random random(5);
  const Guide guide = random_guide(random, 3);
  const double period_s = 0.01, at_s = 0.5 * (guide.time_s[0] + guide.time_s[1]);
  const auto time_after_s = [&](double deviation_rad, GuideProgress& progress) {
    const double before_s = at_s - progress.delay_s;
    JointVector q_rad = point_of(guide, before_s).position_rad;
    q_rad[2] += deviation_rad;
    return guide_time_s(lwa3(), guide, q_rad, at_s, period_s, period_s, progress) - before_s + period_s;
  };
  for (const auto& [deviation_rad, rate] : {std::pair{0.0, 1.0}, {0.05, 1.0}, {0.125, 0.5}, {0.2, 0.1}, {3.0, 0.1}}) {
    GuideProgress progress{guide.time_s[0], 0.3};
    check_near(time_after_s(deviation_rad, progress), rate * period_s, 1e-9);
    check_near(progress.delay_s, 0.3 + (1.0 - rate) * period_s, 1e-9);
  }
  GuideProgress of_another{guide.time_s[0] - 1.0, 0.3};
  guide_time_s(lwa3(), guide, point_of(guide, at_s).position_rad, at_s, period_s, period_s, of_another);
  check_near(of_another.delay_s, 0.0, 0.0);
  guide_time_s(lwa3(), guide, point_of(guide, at_s).position_rad, at_s, period_s, 0.3 * period_s, of_another);
  check_near(of_another.delay_s, 0.7 * period_s, 1e-12);  // an operator's speed
}

void after_its_end_a_guide_is_a_preference_unless_the_arm_waits_there(void**) {
  Random random(3);
  const SidestepGains gains;
  const LinkPoses poses = forward_kinematics(lwa3(), test::home_rad());
  const JointVector q_rad = test::home_rad(), at_rest = JointVector::Zero(7);
  Target target;
  target.position_m = poses.tool_position;
  const TaskJacobian jacobian = tool_jacobian(poses, 3);
  const ObstacleView no_obstacles;
  const Clearance clearance{};
  const LawInput now{lwa3(), poses, jacobian, q_rad, at_rest, target, no_obstacles, clearance, test::any_velocity()};
  Guide guide = random_guide(random, 2);
  const double after_s = guide.end_s() + 1.0;
  const NominalCommand holding = guided_law(gains, now, guide, after_s);
  check((tool_jacobian(poses, 3) * holding.velocity_radps).norm() < 0.02, "the tool is not held");
  check(holding.velocity_radps.norm() > 0.05, "the last knot is not preferred");
  guide.foresight_status = ForesightStatus::kWaiting;
  check_near(guided_law(gains, now, guide, after_s).velocity_radps,
             JointVector(gains.k_guide_per_s * (guide.position_rad[1] - q_rad)), 1e-12);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_guide_rests_in_its_knots_and_before_and_after),
      cmocka_unit_test(the_velocity_of_a_guide_is_the_slope_of_its_position),
      cmocka_unit_test(a_guide_passes_its_knots_at_their_velocities),
      cmocka_unit_test(a_guide_waits_for_an_arm_that_cannot_follow),
      cmocka_unit_test(after_its_end_a_guide_is_a_preference_unless_the_arm_waits_there),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
