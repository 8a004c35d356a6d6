#include "firmware/control/paper/repulsion.h"

#include <memory>

#include "tests/support/check.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::Random;

namespace {

const Vector3 kRest = Vector3::Zero();
const Vector3 kTool(0, 0, 0);

PaperGains gains_of(double k_rpos, double k_rvel) {
  PaperGains gains;
  gains.k_rpos_m2ps2 = k_rpos;
  gains.k_rvel_m2ps2 = k_rvel;
  gains.rho_0_m = 0.25;
  gains.rho_v_m = 0.2;
  gains.rho_min_m = 0.02;
  return gains;
}

void a_resting_obstacle_pushes_straight_away(void**) {
  // eq (9): 0.5 (1/0.1 - 1/0.25) = 3
  check_near(repulsion(gains_of(0.5, 0.1), Vector3(0.1, 0, 0), kRest, kTool, kRest), Vector3(-3, 0, 0), 1e-12);
  check_near(repulsion(gains_of(0.5, 0.1), Vector3(0, 0, -0.1), kRest, kTool, kRest), Vector3(0, 0, 3), 1e-12);
}

void an_approaching_obstacle_pushes_along_its_relative_motion(void**) {
  // eq (10) with V_obj (docs/paper.md item 3): 0.1 (1/0.1 - 1/0.2) = 0.5 along V_obj - V_tool, here (0.6, 0.8, 0).
  const PaperGains gains = gains_of(0.0, 0.1);
  check_near(repulsion(gains, Vector3(-0.1, 0, 0), Vector3(3, 4, 0), kTool, kRest), Vector3(0.3, 0.4, 0), 1e-12);
  check_near(repulsion(gains, Vector3(-0.1, 0, 0), kRest, kTool, Vector3(-3, -4, 0)), Vector3(0.3, 0.4, 0), 1e-12);
}

void an_obstacle_out_of_range_exerts_no_force(void**) {
  const PaperGains gains = gains_of(0.5, 0.1);
  const Vector3 toward(-1, 0, 0);
  check_near(repulsion(gains, Vector3(0.2501, 0, 0), toward, kTool, kRest), kRest, 0);
  // Between rho_v and rho_0 only the position counts: 0.5 (1/0.22 - 1/0.25).
  check_near(repulsion(gains, Vector3(0.22, 0, 0), toward, kTool, kRest), Vector3(-0.5 * (1 / 0.22 - 4), 0, 0), 1e-12);
}

void obstacles_that_recede_or_move_with_the_tool_exert_no_velocity_force(void**) {
  Random random(1);
  const PaperGains gains = gains_of(0.0, 0.1);
  int receding = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    const Vector3 obstacle = random.inside(-0.15, 0.15), v_obstacle = random.inside(-1, 1),
                  v_tool = random.inside(-1, 1);
    if ((v_obstacle - v_tool).dot(kTool - obstacle) > 0) continue;
    check_near_because(repulsion(gains, obstacle, v_obstacle, kTool, v_tool), kRest, 0, "trial %d", trial);
    ++receding;
    check_near_because(repulsion(gains, obstacle, v_tool, kTool, v_tool), kRest, 0, "trial %d", trial);
  }
  check(receding > 300, "%d receding", receding);
}

void the_force_is_finite_at_the_obstacles_centre_and_at_equal_speed(void**) {
  const PaperGains gains;
  for (const double distance_m : {0.0, 1e-320, 1e-200, 1e-12, 1e-6}) {
    const Vector3 obstacle(distance_m, 0, 0);
    for (const Vector3& velocity : {Vector3(0, 0, 0), Vector3(-1, 0, 0), Vector3(-1e-300, 0, 0), Vector3(0, 1, 0)}) {
      const Vector3 force = repulsion(gains, obstacle, velocity, kTool, kRest);
      check(force.allFinite(), "%g m away", distance_m);
      check(force.norm() <= 0.6 * (1 / gains.rho_min_m), "%g m away: %g", distance_m, force.norm());
    }
  }
}

void below_the_least_distance_the_force_is_constant(void**) {
  const PaperGains gains = gains_of(0.5, 0.0);
  const double largest = 0.5 * (1 / 0.02 - 1 / 0.25);
  for (const double distance_m : {0.02, 0.01, 0.001, 1e-9})
    check_near(repulsion(gains, Vector3(distance_m, 0, 0), kRest, kTool, kRest), Vector3(-largest, 0, 0), 1e-9);
}

void the_force_grows_continuously_as_the_distance_shrinks(void**) {
  const PaperGains gains = gains_of(0.5, 0.1);
  double last = 0.0;
  for (double distance_m = 0.26; distance_m > 0.02; distance_m -= 1e-4) {
    const double force = repulsion(gains, Vector3(distance_m, 0, 0), kRest, kTool, kRest).norm();
    check(force >= last, "at %g m the force decreases", distance_m);
    check(force - last < 0.5 * 1e-4 / (distance_m * distance_m) * 1.1, "at %g m the force jumps", distance_m);
    last = force;
  }
  check(last > 20.0, "largest force %g", last);
}

void the_total_force_uses_every_obstacle_at_its_extrapolated_position(void**) {
  Random random(2);
  const PaperGains gains;
  const auto set = std::make_unique<ObstacleSet>();
  for (int trial = 0; trial < 200; ++trial) {
    set->count = random.index(6);
    const double age_s = random.uniform(0, 0.2);
    const Vector3 v_tool = random.inside(-0.5, 0.5);
    Vector3 expected = Vector3::Zero();
    for (int i = 0; i < set->count; ++i) {
      Obstacle& obstacle = set->obstacles[static_cast<size_t>(i)];
      obstacle.capsule.start = obstacle.capsule.end = random.inside(-0.2, 0.2);
      obstacle.capsule.radius_m = 0.05;
      obstacle.velocity_mps = random.inside(-0.5, 0.5);
      const Vector3 now = obstacle.capsule.start + age_s * obstacle.velocity_mps;
      expected += repulsion(gains, now, obstacle.velocity_mps, kTool, v_tool);
    }
    const Vector3 force = repulsion(gains, {set.get(), age_s, 0.0}, kTool, v_tool);
    check_near_because(force, expected, 1e-9, "trial %d", trial);
  }
  check_near(repulsion(gains, ObstacleView{}, kTool, kRest), kRest, 0);
}

void a_long_obstacle_pushes_from_its_nearest_point(void**) {
  const auto set = std::make_unique<ObstacleSet>();
  set->count = 1;
  set->obstacles[0].capsule = {Vector3(0.1, -5, 0), Vector3(0.1, 5, 0), 0.05};
  const PaperGains gains = gains_of(0.5, 0.1);
  check_near(repulsion(gains, {set.get(), 0.0, 0.0}, kTool, kRest), Vector3(-3, 0, 0), 1e-12);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_resting_obstacle_pushes_straight_away),
      cmocka_unit_test(an_approaching_obstacle_pushes_along_its_relative_motion),
      cmocka_unit_test(an_obstacle_out_of_range_exerts_no_force),
      cmocka_unit_test(obstacles_that_recede_or_move_with_the_tool_exert_no_velocity_force),
      cmocka_unit_test(the_force_is_finite_at_the_obstacles_centre_and_at_equal_speed),
      cmocka_unit_test(below_the_least_distance_the_force_is_constant),
      cmocka_unit_test(the_force_grows_continuously_as_the_distance_shrinks),
      cmocka_unit_test(the_total_force_uses_every_obstacle_at_its_extrapolated_position),
      cmocka_unit_test(a_long_obstacle_pushes_from_its_nearest_point),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
