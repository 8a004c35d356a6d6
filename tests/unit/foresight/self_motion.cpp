#include "firmware/foresight/self_motion.h"

#include "firmware/foresight/inverse_kinematics.h"
#include "firmware/model/kinematics.h"
#include "tests/support/check.h"
#include "tests/support/lwa3.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::lwa3;
using test::Random;

namespace {

constexpr double kShare = 0.9;
constexpr double kStrict = 0.01, kLoose = 0.4;  // dampings

Vector3 tool_m(const JointVector& q_rad) {
  return forward_kinematics(lwa3(), q_rad).tool_position;
}

/// Another configuration that has the tool in the same place, to 1 mm. Returns false if none was found.
bool with_the_same_place(const JointVector& q_rad, double range_rad, Random& random, JointVector& other_rad) {
  Target place;
  place.position_m = tool_m(q_rad);
  other_rad = (q_rad + random.joints(7, -range_rad, range_rad))
                  .cwiseMax(lwa3().limits.lower_rad)
                  .cwiseMin(lwa3().limits.upper_rad);
  return solve_ik(lwa3(), place, other_rad);
}

/// Calls use(guide, start, end) for self-motions that keep the tool strictly in place, and for some that do not.
template <typename Use>
void for_self_motions(uint64_t seed, const Use& use) {
  Random random(seed);
  int found = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const JointVector start_rad = random.configuration(lwa3(), 0.9);
    JointVector end_rad;
    if (!with_the_same_place(start_rad, 1.5, random, end_rad)) continue;
    SelfMotion motion(lwa3(), start_rad, tool_m(start_rad), trial % 2 == 0 ? kStrict : kLoose);
    if (!motion.reach(end_rad)) continue;
    use(motion.guide(5.0, kShare), start_rad, end_rad);
    ++found;
  }
  check(found > 200, "only %d of 400", found);
}

/// The farthest that the tool is from where it began.
double farthest_m(const Guide& guide) {
  double most_m = 0.0;
  for (double at_s = guide.time_s[0]; at_s < guide.end_s(); at_s += 0.01) {
    const double away_m = (tool_m(point_of(guide, at_s).position_rad) - tool_m(guide.position_rad[0])).norm();
    most_m = std::max(most_m, away_m);
  }
  return most_m;
}

void a_self_motion_leads_from_rest_to_rest(void**) {
  for_self_motions(1, [](const Guide& guide, const JointVector& start_rad, const JointVector& end_rad) {
    check_near(guide.time_s[0], 5.0, 0.0);
    check_near(point_of(guide, 5.0).position_rad, start_rad, 1e-12);
    check_near(point_of(guide, guide.end_s()).position_rad, end_rad, 1e-12);
    check_near(guide.velocity_radps[static_cast<size_t>(guide.knots - 1)], JointVector::Zero(7), 0.0);
  });
}

void the_tool_stays_in_place_the_more_strictly_the_less_damping(void**) {
  Random random(4);
  int strict_ones = 0, loose_ones = 0;
  double loose_m = 0.0, straight_m = 0.0;
  for (int trial = 0; trial < 400; ++trial) {
    const JointVector start_rad = random.configuration(lwa3(), 0.9);
    JointVector end_rad;
    if (!with_the_same_place(start_rad, 2.0, random, end_rad)) continue;
    SelfMotion strict(lwa3(), start_rad, tool_m(start_rad), kStrict);
    if (strict.reach(end_rad)) {
      ++strict_ones;
      const double away_m = farthest_m(strict.guide(0.0, kShare));
      check(away_m < 0.02, "strictly, but %g m away", away_m);
    }
    SelfMotion loose(lwa3(), start_rad, tool_m(start_rad), kLoose);
    if (!loose.reach(end_rad)) continue;
    ++loose_ones;
    loose_m += farthest_m(loose.guide(0.0, kShare));
    Guide straight;
    straight.add(0.0, start_rad);
    straight.add(1.0, end_rad);
    straight_m += farthest_m(straight);
  }
  check(strict_ones > 150 && loose_ones > strict_ones, "%d and %d of 400", strict_ones, loose_ones);
  check(loose_m < 0.4 * straight_m, "%g m in the mean, and %g m on the straight way", loose_m / loose_ones,
        straight_m / loose_ones);
}

/// It then begins by going there.
void a_tool_that_is_not_in_place_comes_back(void**) {
  Random random(5);
  int found = 0;
  for (int trial = 0; trial < 100; ++trial) {
    const JointVector start_rad = random.configuration(lwa3(), 0.9);
    JointVector end_rad;
    if (!with_the_same_place(start_rad, 1.5, random, end_rad)) continue;
    const Vector3 place_m = tool_m(end_rad);
    const JointVector beside_rad = start_rad + random.joints(7, -0.03, 0.03);
    SelfMotion motion(lwa3(), beside_rad, place_m, kStrict);
    if (!motion.reach(end_rad)) continue;
    const Guide guide = motion.guide(0.0, kShare);
    const double then_m = (tool_m(point_of(guide, 0.7 * guide.end_s()).position_rad) - place_m).norm();
    check(then_m < 0.02, "%g m away", then_m);
    ++found;
  }
  check(found > 30, "only %d of 100", found);
}

/// By differences of positions alone.
void velocities_and_accelerations_stay_within_the_limits(void**) {
  const double h_s = 1e-3;
  const JointLimits& limits = lwa3().limits;
  for_self_motions(2, [&](const Guide& guide, const JointVector&, const JointVector&) {
    for (double at_s = guide.time_s[0] + h_s; at_s < guide.end_s() - h_s; at_s += 3.0 * h_s) {
      const JointVector before = point_of(guide, at_s - h_s).position_rad, now = point_of(guide, at_s).position_rad,
                        after = point_of(guide, at_s + h_s).position_rad;
      const double speed = ((after - before) / (2.0 * h_s)).cwiseQuotient(limits.velocity_radps).cwiseAbs().maxCoeff();
      const double acceleration =
          ((after - 2.0 * now + before) / (h_s * h_s)).cwiseQuotient(limits.acceleration_radps2).cwiseAbs().maxCoeff();
      check(speed < 1.0, "%g of the velocity limit", speed);
      check(acceleration < 1.0, "%g of the acceleration limit", acceleration);
    }
  });
}

void a_way_that_the_position_limits_close_is_refused(void**) {
  Random random(3);
  int refused = 0;
  for (int trial = 0; trial < 100; ++trial) {
    const JointVector start_rad = random.configuration(lwa3(), 0.9);
    JointVector end_rad;
    if (!with_the_same_place(start_rad, 6.0, random, end_rad)) continue;
    SelfMotion motion(lwa3(), start_rad, tool_m(start_rad), kStrict);
    if (!motion.reach(end_rad)) ++refused;
  }
  check(refused > 10, "only %d", refused);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_self_motion_leads_from_rest_to_rest),
      cmocka_unit_test(the_tool_stays_in_place_the_more_strictly_the_less_damping),
      cmocka_unit_test(a_tool_that_is_not_in_place_comes_back),
      cmocka_unit_test(velocities_and_accelerations_stay_within_the_limits),
      cmocka_unit_test(a_way_that_the_position_limits_close_is_refused),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
