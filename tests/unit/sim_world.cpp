#include "host/sim/world.h"

#include "tests/support/check.h"

using namespace sidestep::sim;

namespace {

World moving_world() {
  World world;
  world.target.motion.position_m = {1, 2, 3};
  world.target.motion.velocity_mps = {0.1, 0, -0.2};
  Obstacle bar{7, {Shape::kCapsule, {0.05, 0.3, 0}}, {}};
  bar.motion.velocity_mps = {0, 0.5, 0};
  bar.motion.orientation = Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitY());
  bar.motion.angular_velocity_radps = {0, 0, M_PI};
  world.obstacles = {bar};
  return world;
}

void at_zero_nothing_has_moved(void**) {
  const World world = later(moving_world(), 0);
  check_near(world.target.motion.position_m, Eigen::Vector3d(1, 2, 3), 0);
  check_near(world.obstacles[0].motion.position_m, Eigen::Vector3d(0, 0, 0), 0);
}

void positions_follow_constant_velocities(void**) {
  const World world = later(moving_world(), 2);
  check_near(world.target.motion.position_m, Eigen::Vector3d(1.2, 2, 2.6), 1e-15);
  check_near(world.obstacles[0].motion.position_m, Eigen::Vector3d(0, 1, 0), 1e-15);
  check_near(world.obstacles[0].motion.velocity_mps, Eigen::Vector3d(0, 0.5, 0), 0);
  assert_int_equal(world.obstacles[0].id, 7);
}

void a_half_turn_a_second_points_the_other_way_after_a_second(void**) {
  const auto axis_after = [](double dt_s) -> Eigen::Vector3d {
    return later(moving_world(), dt_s).obstacles[0].motion.orientation * Eigen::Vector3d::UnitZ();
  };
  check_near(axis_after(0), Eigen::Vector3d(1, 0, 0), 1e-15);
  check_near(axis_after(0.5), Eigen::Vector3d(0, 1, 0), 1e-15);
  check_near(axis_after(1), Eigen::Vector3d(-1, 0, 0), 1e-15);
  check_near(axis_after(1000.5), Eigen::Vector3d(0, 1, 0), 1e-12);
}

void many_small_steps_lead_to_the_same_place(void**) {
  World stepped = moving_world();
  for (int i = 0; i < 1000; ++i) stepped = later(stepped, 0.001);
  const World at_once = later(moving_world(), 1);
  const Motion &a = stepped.obstacles[0].motion, &b = at_once.obstacles[0].motion;
  check_near(a.position_m, b.position_m, 1e-12);
  check_near(a.orientation.coeffs(), b.orientation.coeffs(), 1e-12);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(at_zero_nothing_has_moved),
      cmocka_unit_test(positions_follow_constant_velocities),
      cmocka_unit_test(a_half_turn_a_second_points_the_other_way_after_a_second),
      cmocka_unit_test(many_small_steps_lead_to_the_same_place),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
