#include "firmware/foresight/path_timing.h"

#include "firmware/model/kinematics.h"
#include "tests/support/check.h"
#include "tests/support/lwa3.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::lwa3;
using test::Random;

namespace {

using Path = JointPath;

constexpr double kShare = 0.9;

bool anywhere(const JointVector&) {
  return true;
}

Path random_path(Random& random, int points) {
  Path path;
  for (int i = 0; i < points; ++i) path.add(random.configuration(lwa3()));
  return path;
}

/// From a configuration to the nearest point of the polyline.
double distance_rad(const Path& path, const JointVector& q_rad) {
  double least = HUGE_VAL;
  for (int i = 0; i + 1 < path.size(); ++i) {
    const JointVector way = path[i + 1] - path[i];
    const double share = std::clamp(way.dot(q_rad - path[i]) / way.squaredNorm(), 0.0, 1.0);
    least = std::min(least, (q_rad - path[i] - share * way).norm());
  }
  return least;
}

void a_timed_path_leads_from_rest_to_rest_near_the_polyline(void**) {
  Random random(1);
  for (int trial = 0; trial < 100; ++trial) {
    const Path path = random_path(random, 2 + trial % 6);
    const Guide guide = timed_guide(lwa3(), path, kShare, 5.0, anywhere);
    assert_true(guide.knots > 1);
    check_near(guide.time_s[0], 5.0, 0.0);
    check_near(point_of(guide, 5.0).position_rad, path[0], 1e-12);
    check_near(point_of(guide, guide.end_s()).position_rad, path[path.size() - 1], 1e-9);
    check_near(guide.velocity_radps[static_cast<size_t>(guide.knots - 1)], JointVector::Zero(7), 1e-9);
    for (double at_s = 5.0; at_s < guide.end_s(); at_s += 0.01)
      check(distance_rad(path, point_of(guide, at_s).position_rad) < 0.21, "trial %d at %g s", trial, at_s);
  }
}

/// By differences of positions alone.
void velocities_and_accelerations_stay_within_the_limits(void**) {
  Random random(2);
  const double h_s = 1e-3;
  const JointLimits& limits = lwa3().limits;
  for (int trial = 0; trial < 60; ++trial) {
    const Guide guide = timed_guide(lwa3(), random_path(random, 2 + trial % 6), kShare, 0.0, anywhere);
    for (double at_s = -h_s; at_s < guide.end_s() + h_s; at_s += h_s) {
      const JointVector before = point_of(guide, at_s - h_s).position_rad, now = point_of(guide, at_s).position_rad,
                        after = point_of(guide, at_s + h_s).position_rad;
      const JointVector speed = (after - before) / (2.0 * h_s), change = (after - 2.0 * now + before) / (h_s * h_s);
      assert_true((speed.cwiseAbs().array() <= kShare * limits.velocity_radps.array() + 1e-6).all());
      assert_true((change.cwiseAbs().array() <= kShare * limits.acceleration_radps2.array() + 1e-3).all());
    }
  }
}

/// A joint that turns by 2 rad at 1.5 rad/s^2 and at most 1 rad/s needs 2 + 2/3 s.
void a_straight_way_takes_the_least_time(void**) {
  Arm arm = lwa3();
  arm.limits.velocity_radps.setConstant(1.0);
  arm.limits.acceleration_radps2.setConstant(1.5);
  JointVector end = test::home_rad();
  end[4] += 2.0;
  Path path;
  path.add(test::home_rad());
  path.add(end);
  check_near(timed_guide(arm, path, 1.0, 0.0, anywhere).end_s(), 2.0 + 2.0 / 3.0, 1e-9);
}

/// The speed is that of the fastest point of the way, so that the tool reaches its limit once.
void the_tool_keeps_its_speed_limit_on_a_straight_way(void**) {
  Random random(3);
  const double limit_mps = 0.25;
  for (int trial = 0; trial < 50; ++trial) {
    const Guide guide = timed_guide(lwa3(), random_path(random, 2), kShare, 0.0, anywhere, limit_mps);
    double fastest_mps = 0.0;
    for (double at_s = 0.0; at_s < guide.end_s(); at_s += 0.01) {
      const GuidePoint point = point_of(guide, at_s);
      const TaskJacobian jacobian = tool_jacobian(forward_kinematics(lwa3(), point.position_rad), 3);
      fastest_mps = std::max(fastest_mps, (jacobian * point.velocity_radps).norm());
    }
    check(fastest_mps < 1.02 * limit_mps && fastest_mps > 0.9 * limit_mps, "trial %d: %g m/s", trial, fastest_mps);
  }
}

void a_corner_that_cannot_be_blended_is_a_stop(void**) {
  Random random(3);
  for (int trial = 0; trial < 20; ++trial) {
    const Path path = random_path(random, 3);
    const auto on_path = [&](const JointVector& q_rad) { return distance_rad(path, q_rad) < 1e-6; };
    const Guide stops = timed_guide(lwa3(), path, kShare, 0.0, on_path);
    const Guide flows = timed_guide(lwa3(), path, kShare, 0.0, anywhere);
    check(flows.end_s() < stops.end_s() - 0.01, "%g s, with a stop %g s", flows.end_s(), stops.end_s());
    double least_rad = HUGE_VAL;
    for (double at_s = 0.0; at_s < stops.end_s(); at_s += 1e-3)
      least_rad = std::min(least_rad, (point_of(stops, at_s).position_rad - path[1]).norm());
    check(least_rad < 1e-3, "%g rad from the corner", least_rad);
  }
}

void a_path_with_too_many_corners_gives_no_guide(void**) {
  Random random(4);
  assert_int_equal(timed_guide(lwa3(), random_path(random, kMaxKnots + 2), kShare, 0.0, anywhere).knots, 0);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_timed_path_leads_from_rest_to_rest_near_the_polyline),
      cmocka_unit_test(velocities_and_accelerations_stay_within_the_limits),
      cmocka_unit_test(a_straight_way_takes_the_least_time),
      cmocka_unit_test(the_tool_keeps_its_speed_limit_on_a_straight_way),
      cmocka_unit_test(a_corner_that_cannot_be_blended_is_a_stop),
      cmocka_unit_test(a_path_with_too_many_corners_gives_no_guide),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
