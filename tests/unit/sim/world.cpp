#include "host/sim/world.h"

#include "tests/support/check.h"

using namespace sidestep::sim;
using sidestep::CapsuleMotion;
using sidestep::CapsulePath;

namespace {

World moving_world() {
  World world;
  world.target.emplace();
  world.target->motion.position_m = {1, 2, 3};
  world.target->motion.velocity_mps = {0.1, 0, -0.2};
  Obstacle bar{7, {Shape::kCapsule, {0.05, 0.3, 0}}, {}};
  bar.motion.velocity_mps = {0, 0.5, 0};
  bar.motion.orientation = Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitY());
  bar.motion.angular_velocity_radps = {0, 0, M_PI};
  world.obstacles = {bar};
  return world;
}

void after_zero_seconds_the_world_is_unchanged(void**) {
  const World world = advanced(moving_world(), 0);
  check_near(world.target->motion.position_m, Eigen::Vector3d(1, 2, 3), 0);
  check_near(world.obstacles[0].motion.position_m, Eigen::Vector3d(0, 0, 0), 0);
}

void positions_follow_constant_velocities(void**) {
  const World world = advanced(moving_world(), 2);
  check_near(world.target->motion.position_m, Eigen::Vector3d(1.2, 2, 2.6), 1e-15);
  check_near(world.obstacles[0].motion.position_m, Eigen::Vector3d(0, 1, 0), 1e-15);
  check_near(world.obstacles[0].motion.velocity_mps, Eigen::Vector3d(0, 0.5, 0), 0);
  assert_int_equal(world.obstacles[0].id, 7);
}

void rotation_by_constant_angular_velocity_is_exact(void**) {
  const auto axis_after = [](double dt_s) -> Eigen::Vector3d {
    return advanced(moving_world(), dt_s).obstacles[0].motion.orientation * Eigen::Vector3d::UnitZ();
  };
  check_near(axis_after(0), Eigen::Vector3d(1, 0, 0), 1e-15);
  check_near(axis_after(0.5), Eigen::Vector3d(0, 1, 0), 1e-15);
  check_near(axis_after(1), Eigen::Vector3d(-1, 0, 0), 1e-15);
  check_near(axis_after(1000.5), Eigen::Vector3d(0, 1, 0), 1e-12);
}

void small_steps_and_one_large_step_give_the_same_pose(void**) {
  World stepped = moving_world();
  for (int i = 0; i < 1000; ++i) stepped = advanced(stepped, 0.001);
  const World at_once = advanced(moving_world(), 1);
  const Motion &a = stepped.obstacles[0].motion, &b = at_once.obstacles[0].motion;
  check_near(a.position_m, b.position_m, 1e-12);
  check_near(a.orientation.coeffs(), b.orientation.coeffs(), 1e-12);
}

/// A path with waypoints at uneven times that returns to its start.
Motion curved_motion() {
  const Path path{{0, {1, 2, 3}, {0.2, 0, 0}}, {0.5, {1.1, 2, 3.2}, {0, 0, 0.4}}, {0.8, {1, 2, 3}, {-0.3, 0.1, 0}}};
  Motion motion;
  motion.position_m = path.front().position_m;
  motion.velocity_mps = path.front().velocity_mps;
  motion.path = std::make_shared<const Path>(path);
  return motion;
}

Motion curved_after(double dt_s) {
  World world;
  world.obstacles = {{1, {Shape::kSphere, {0.05, 0, 0}}, curved_motion()}};
  return advanced(world, dt_s).obstacles[0].motion;
}

void a_path_goes_through_its_waypoints(void**) {
  const Motion start = curved_motion();
  for (const Waypoint& waypoint : *start.path) {
    const Motion motion = curved_after(waypoint.t_s);
    check_near(motion.position_m, waypoint.position_m, 0);
    check_near(motion.velocity_mps, waypoint.velocity_mps, 0);
    const Motion before = curved_after(waypoint.t_s - 1e-9);
    check_near(before.position_m, waypoint.position_m, 1e-9);
    check_near(before.velocity_mps, waypoint.velocity_mps, 1e-7);
  }
}

void position_and_velocity_half_the_time_between_two_waypoints(void**) {
  // Mean of the positions + duration / 8 * difference of the velocities; 1.5 mean velocity - quarter of their sum.
  const Motion motion = curved_after(0.25);
  check_near(motion.position_m, Eigen::Vector3d(1.05 + 0.0125, 2, 3.1 - 0.025), 1e-15);
  check_near(motion.velocity_mps, Eigen::Vector3d(0.3 - 0.05, 0, 0.6 - 0.1), 1e-15);
}

void a_cubic_is_followed_exactly(void**) {
  const auto cubic = [](double t) -> Waypoint { return {t, {t * t * t, 1 - t * t, 2 * t}, {3 * t * t, -2 * t, 2}}; };
  const Path path{cubic(0), cubic(0.3), cubic(1)};
  for (double t_s = 0; t_s < 1; t_s += 0.01) {
    check_near(waypoint_at(path, t_s).position_m, cubic(t_s).position_m, 1e-15);
    check_near(waypoint_at(path, t_s).velocity_mps, cubic(t_s).velocity_mps, 1e-14);
  }
}

void the_velocity_on_a_path_is_the_derivative_of_the_position(void**) {
  constexpr double kStep_s = 1e-5;
  for (double t_s = 0.005; t_s < 1.2; t_s += 0.01) {
    const Eigen::Vector3d difference_m =
        curved_after(t_s + kStep_s).position_m - curved_after(t_s - kStep_s).position_m;
    check_near(curved_after(t_s).velocity_mps, difference_m / (2 * kStep_s), 1e-8);
  }
}

void after_its_end_a_path_continues_at_constant_velocity(void**) {
  const Motion motion = curved_after(2.8);
  check_near(motion.position_m, Eigen::Vector3d(1 - 0.6, 2 + 0.2, 3), 1e-15);
  check_near(motion.velocity_mps, Eigen::Vector3d(-0.3, 0.1, 0), 0);
  const Path to_rest{{0, {0, 0, 0}, {1, 0, 0}}, {1, {0.5, 0, 0}, {0, 0, 0}}};
  check_near(waypoint_at(to_rest, 100).position_m, Eigen::Vector3d(0.5, 0, 0), 0);
  check_near(waypoint_at(to_rest, 100).velocity_mps, Eigen::Vector3d(0, 0, 0), 0);
}

void a_target_follows_its_path_with_constant_angular_velocity(void**) {
  World world;
  world.target.emplace();
  world.target->motion = curved_motion();
  world.target->motion.angular_velocity_radps = {0, 0, M_PI};
  const Motion motion = advanced(world, 0.5).target->motion;
  check_near(motion.position_m, Eigen::Vector3d(1.1, 2, 3.2), 0);
  check_near(motion.orientation * Eigen::Vector3d::UnitX(), Eigen::Vector3d(0, 1, 0), 1e-15);
}

void small_steps_along_a_path_end_at_the_same_position(void**) {
  World stepped;
  stepped.target.emplace();
  stepped.target->motion = curved_motion();
  for (int i = 0; i < 700; ++i) stepped = advanced(stepped, 0.001);
  check_near(stepped.target->motion.position_m, curved_after(0.7).position_m, 1e-12);
  check_near(stepped.target->motion.velocity_mps, curved_after(0.7).velocity_mps, 1e-12);
}

/// A limb of 0.3 m that turns about z and moves along x.
CapsulePath swinging_limb() {
  std::vector<CapsulePath::Ends> samples;
  for (int k = 0; k <= 200; ++k) {
    const double t_s = 0.01 * k, x_m = 0.2 * std::sin(2.0 * t_s), angle_rad = 1.5 * t_s;
    const Eigen::Vector3d start_m(x_m, 0.1, 0.8);
    samples.push_back({start_m, start_m + 0.3 * Eigen::Vector3d(std::cos(angle_rad), std::sin(angle_rad), 0.2)});
  }
  return {0.05, 0.01, samples};
}

World world_with_limb() {
  World world;
  world.obstacles = {{1, {Shape::kCapsule, {0.05, 0.3, 0}}, motion_of_limb(swinging_limb()), true}};
  return world;
}

void a_limb_lies_and_moves_as_its_capsule(void**) {
  World stepped = world_with_limb();
  for (int i = 0; i < 150; ++i) stepped = advanced(stepped, 0.01);
  const Motion& motion = stepped.obstacles[0].motion;
  const CapsuleMotion truth = swinging_limb().at(1.5);
  const Eigen::Vector3d axis = (truth.capsule.end - truth.capsule.start).normalized();
  check_near(motion.position_m, truth.capsule.centre(), 1e-9);
  check_near(motion.orientation * Eigen::Vector3d::UnitZ(), axis, 1e-9);
  check_near(motion.velocity_mps, truth.centre_mps(), 1e-6);
  check_near(motion.angular_velocity_radps, truth.angular_radps(), 1e-6);
}

void a_limb_is_the_same_in_another_frame(void**) {
  const Eigen::Isometry3d pose =
      Eigen::Translation3d(1, 2, 3) * Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 2).normalized());
  const Motion first = transformed(pose, advanced(world_with_limb(), 0.8)).obstacles[0].motion,
               second = advanced(transformed(pose, world_with_limb()), 0.8).obstacles[0].motion;
  check_near(second.position_m, first.position_m, 1e-12);
  check_near(second.orientation * Eigen::Vector3d::UnitZ(), first.orientation * Eigen::Vector3d::UnitZ(), 1e-12);
  check_near(second.velocity_mps, first.velocity_mps, 1e-12);
  check_near(second.angular_velocity_radps, first.angular_velocity_radps, 1e-12);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(after_zero_seconds_the_world_is_unchanged),
      cmocka_unit_test(positions_follow_constant_velocities),
      cmocka_unit_test(rotation_by_constant_angular_velocity_is_exact),
      cmocka_unit_test(small_steps_and_one_large_step_give_the_same_pose),
      cmocka_unit_test(a_path_goes_through_its_waypoints),
      cmocka_unit_test(position_and_velocity_half_the_time_between_two_waypoints),
      cmocka_unit_test(a_cubic_is_followed_exactly),
      cmocka_unit_test(the_velocity_on_a_path_is_the_derivative_of_the_position),
      cmocka_unit_test(after_its_end_a_path_continues_at_constant_velocity),
      cmocka_unit_test(a_target_follows_its_path_with_constant_angular_velocity),
      cmocka_unit_test(small_steps_along_a_path_end_at_the_same_position),
      cmocka_unit_test(a_limb_lies_and_moves_as_its_capsule),
      cmocka_unit_test(a_limb_is_the_same_in_another_frame),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
