#include "host/campaign/furniture/timed_path.h"

#include "tests/support/check.h"
#include "tests/support/random.h"

using namespace sidestep;
using namespace sidestep::campaign;

namespace {

Limits some_limits(test::Random& random) {
  Limits limits;
  limits.velocity_radps = random.joints(7, 0.5, 2.0);
  limits.acceleration_radps2 = random.joints(7, 2.0, 20.0);
  return limits;
}

std::vector<Joints> some_knots(test::Random& random) {
  std::vector<Joints> knots_rad;
  for (int k = 0; k < 4; ++k) knots_rad.push_back(random.joints(7, -2.0, 2.0));
  return knots_rad;
}

/// The extremes of the velocity and of its slope, as shares of the limits.
void a_timed_path_uses_the_share_of_the_limits_and_no_more(void**) {
  test::Random random(1);
  for (int trial = 0; trial < 20; ++trial) {
    const Limits limits = some_limits(random);
    const TimedPath path(some_knots(random), limits, 0.8);
    constexpr double kStep_s = 1e-4;
    double speed = 0.0, acceleration = 0.0;
    for (double t_s = 0.0; t_s < path.duration_s(); t_s += kStep_s) {
      const Joints qd_radps = (path.position_rad(t_s + kStep_s) - path.position_rad(t_s)) / kStep_s;
      const Joints before_radps = (path.position_rad(t_s) - path.position_rad(t_s - kStep_s)) / kStep_s;
      speed = std::max(speed, qd_radps.cwiseAbs().cwiseQuotient(limits.velocity_radps).maxCoeff());
      const Joints change_radps2 = (qd_radps - before_radps).cwiseAbs() / kStep_s;
      acceleration = std::max(acceleration, change_radps2.cwiseQuotient(limits.acceleration_radps2).maxCoeff());
      check_near(path.velocity_radps(t_s + 0.5 * kStep_s), qd_radps, 3e-3);
    }
    check(speed < 0.801 && acceleration < 0.801, "%g of the speed, %g of the acceleration", speed, acceleration);
    check(speed > 0.79 || acceleration > 0.79, "%g of the speed, %g of the acceleration", speed, acceleration);
  }
}

void a_timed_path_passes_all_knots_on_straight_lines(void**) {
  test::Random random(2);
  const std::vector<Joints> knots_rad = some_knots(random);
  const TimedPath path(knots_rad, some_limits(random), 1.0);
  size_t next = 0;
  double length_rad = 0.0;
  Joints last_rad = knots_rad.front();
  for (double t_s = -0.1; t_s < path.duration_s() + 0.1; t_s += 1e-3) {
    const Joints q_rad = path.position_rad(t_s);
    length_rad += (q_rad - last_rad).norm();
    last_rad = q_rad;
    if (next < knots_rad.size() && (q_rad - knots_rad[next]).norm() < 1e-3) ++next;
  }
  check(next == knots_rad.size(), "%zu knots", next);
  check_near(last_rad, knots_rad.back(), 0.0);
  check_near(path.length_rad(), length_rad, 1e-2);  // longer if it left the straight lines
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_timed_path_uses_the_share_of_the_limits_and_no_more),
      cmocka_unit_test(a_timed_path_passes_all_knots_on_straight_lines),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
