#include "host/campaign/sphere_path.h"

#include "tests/support/check.h"
#include "tests/support/random.h"

using namespace sidestep::campaign;
using sidestep::test::Random;

namespace {

SpherePath random_path(Random& random) {
  SpherePath path(random.inside(-1, 1), random.inside(-0.4, 0.4));
  for (int i = 0; i < 8; ++i) path.add_knot(random.uniform(0.5, 2.0), random.inside(-0.4, 0.4));
  return path;
}

void a_straight_path_has_constant_velocity(void**) {
  const SpherePath path({1, 2, 3}, {0.1, 0, -0.2});
  check(path.straight(), "no knots were added");
  check_near(path.at(10.0).position_m, Vector3(2, 2, 1), 1e-12);
  check_near(path.at(10.0).velocity_mps, Vector3(0.1, 0, -0.2), 0.0);
}

void before_the_start_time_the_position_is_the_start(void**) {
  const SpherePath path({1, 2, 3}, {0.1, 0, -0.2});
  check_near(path.at(-1.0).position_m, Vector3(1, 2, 3), 0.0);
  check_near(path.at(-1.0).velocity_mps, Vector3(0.1, 0, -0.2), 0.0);
}

void a_knot_has_its_time_position_and_velocity(void**) {
  SpherePath path({0, 0, 0}, {0.2, 0, 0});
  path.add_knot(2.0, {0, 0.4, 0});
  check_near(path.at(2.0).velocity_mps, Vector3(0, 0.4, 0), 1e-12);
  check_near(path.at(1.0).velocity_mps, Vector3(0.1, 0.2, 0), 1e-12);
  check_near(path.at(2.0).position_m, Vector3(0.2, 0.4, 0), 1e-12);
  check_near(path.at(5.0).position_m, Vector3(0.2, 1.6, 0), 1e-12);
}

void velocity_is_the_derivative_of_the_position(void**) {
  Random random(1);
  for (int trial = 0; trial < 50; ++trial) {
    const SpherePath path = random_path(random);
    for (double t_s = 0.01; t_s < path.last_knot_s() + 1.0; t_s += 0.037) {
      const double h_s = 1e-5;
      const Vector3 slope_mps = (path.at(t_s + h_s).position_m - path.at(t_s - h_s).position_m) / (2 * h_s);
      check_near_because(path.at(t_s).velocity_mps, slope_mps, 1e-6, "t = %g", t_s);
    }
  }
}

/// A minimum-jerk blend starts and ends with zero acceleration, so the acceleration does not jump at a knot. The
/// largest acceleration is 1.875 dv / T.
void acceleration_is_continuous_and_bounded(void**) {
  Random random(2);
  for (int trial = 0; trial < 50; ++trial) {
    const SpherePath path = random_path(random);
    const double h_s = 1e-3;
    Vector3 before_mps2 = Vector3::Zero();
    for (double t_s = h_s; t_s < path.last_knot_s() + 1.0; t_s += h_s) {
      const Vector3 mps2 = (path.at(t_s + h_s).velocity_mps - path.at(t_s).velocity_mps) / h_s;
      check(mps2.norm() < 1.875 * 1.4 / 0.5, "%g", mps2.norm());
      check((mps2 - before_mps2).norm() < 0.1, "jumps by %g at %g s", (mps2 - before_mps2).norm(), t_s);
      before_mps2 = mps2;
    }
  }
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_straight_path_has_constant_velocity),
      cmocka_unit_test(before_the_start_time_the_position_is_the_start),
      cmocka_unit_test(a_knot_has_its_time_position_and_velocity),
      cmocka_unit_test(velocity_is_the_derivative_of_the_position),
      cmocka_unit_test(acceleration_is_continuous_and_bounded),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
