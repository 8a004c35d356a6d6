#include "firmware/model/obstacle.h"

#include "tests/support/check.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::Random;

namespace {

void a_moving_sphere_moves_straight(void**) {
  Obstacle sphere;
  sphere.capsule = {Vector3(1, 2, 3), Vector3(1, 2, 3), 0.1};
  sphere.velocity_mps = Vector3(0.5, -1, 2);
  sphere.angular_velocity_radps = Vector3(9, 9, 9);
  const Capsule later = extrapolated(sphere, 0.5).capsule;
  check_near(later.start, Vector3(1.25, 1.5, 4), 1e-15);
  check_near(later.end, Vector3(1.25, 1.5, 4), 1e-15);
  check_near(later.radius_m, 0.1, 0);
}

void a_quarter_turn_rotates_the_ends_about_the_centre(void**) {
  Obstacle bar;
  bar.shape = Shape::kCapsule;
  bar.capsule = {Vector3(1, 0, 0), Vector3(3, 0, 0), 0.1};
  bar.velocity_mps = Vector3(0, 0, 1);
  bar.angular_velocity_radps = Vector3(0, 0, M_PI);
  const Capsule later = extrapolated(bar, 0.5).capsule;
  check_near(later.start, Vector3(2, -1, 0.5), 1e-15);
  check_near(later.end, Vector3(2, 1, 0.5), 1e-15);
}

/// The ends obey p' = v + w x (p - centre), integrated here in small steps.
void extrapolation_agrees_with_numerical_integration(void**) {
  Random random(1);
  for (int trial = 0; trial < 50; ++trial) {
    Obstacle bar;
    bar.shape = Shape::kCapsule;
    bar.capsule = {random.inside(-1, 1), random.inside(-1, 1), 0.1};
    bar.velocity_mps = random.inside(-1, 1);
    bar.angular_velocity_radps = random.inside(-2, 2);
    const double duration_s = random.uniform(-0.5, 0.5);
    const int steps = 2000;
    const double dt_s = duration_s / steps;
    Vector3 centre = 0.5 * (bar.capsule.start + bar.capsule.end), half = bar.capsule.end - centre;
    for (int i = 0; i < steps; ++i) {
      const Vector3 middle = half + 0.5 * dt_s * bar.angular_velocity_radps.cross(half);
      half += dt_s * bar.angular_velocity_radps.cross(middle);
      centre += dt_s * bar.velocity_mps;
    }
    const Capsule later = extrapolated(bar, duration_s).capsule;
    check_near_because(later.end, centre + half, 1e-5, "trial %d", trial);
    check_near_because(later.start, centre - half, 1e-5, "trial %d", trial);
  }
}

void extrapolation_by_no_time_changes_nothing(void**) {
  Random random(2);
  Obstacle bar;
  bar.shape = Shape::kCapsule;
  bar.capsule = {random.inside(-1, 1), random.inside(-1, 1), 0.1};
  bar.velocity_mps = random.inside(-1, 1);
  bar.angular_velocity_radps = random.inside(-2, 2);
  check_near(extrapolated(bar, 0.0).capsule.start, bar.capsule.start, 0);
  check_near(extrapolated(bar, 0.0).capsule.end, bar.capsule.end, 0);
}

void a_box_keeps_its_edges_in_any_order_and_rotates_rigidly(void**) {
  Random random(3);
  for (int trial = 0; trial < 200; ++trial) {
    const Quaternion turn = random.turn();
    const Vector3 centre = random.inside(-1, 1), edges = random.inside(0.01, 1);
    Obstacle obstacle = box_obstacle(centre, turn.toRotationMatrix(), edges);
    obstacle.angular_velocity_radps = random.inside(-2, 2);
    const double dt_s = random.uniform(0, 1), angle = obstacle.angular_velocity_radps.norm() * dt_s;
    const Eigen::AngleAxisd by(angle, obstacle.angular_velocity_radps.normalized());
    const Box later = box_of(extrapolated(obstacle, dt_s));
    // Each of the eight expected corners is a corner of the extrapolated box.
    for (int corner = 0; corner < 8; ++corner) {
      const Vector3 sign(corner & 1 ? 0.5 : -0.5, corner & 2 ? 0.5 : -0.5, corner & 4 ? 0.5 : -0.5);
      const Vector3 p = later.axes.transpose() * (by * (turn * sign.cwiseProduct(edges)));
      check_near_because(p.cwiseAbs().eval(), later.half_m, 1e-12, "trial %d, corner %d", trial, corner);
    }
    check_near_because(later.centre, centre, 1e-12, "trial %d", trial);
    check_near_because(inflation_m(extrapolated(obstacle, dt_s)), 0.0, 1e-12, "trial %d", trial);
  }
}

void a_box_without_width_is_stored_as_a_capsule_and_one_without_height_as_a_box(void**) {
  const Obstacle line = box_obstacle(Vector3::Zero(), Matrix3::Identity(), Vector3(0, 0, 0.4));
  assert_true(line.shape == Shape::kCapsule);
  check_near((line.capsule.end - line.capsule.start).norm(), 0.4, 1e-12);
  const auto shape_of = [](const Vector3& edges_m) {
    return box_obstacle(Vector3::Zero(), Matrix3::Identity(), edges_m).shape;
  };
  assert_true(shape_of(Vector3(0.3, 0, 0.4)) == Shape::kBox);
  assert_true(shape_of(Vector3(1.9e-6, 0, 0.4)) == Shape::kCapsule);
  assert_true(shape_of(Vector3(2.1e-6, 0, 0.4)) == Shape::kBox);
}

void velocity_at_a_point_is_the_derivative_of_that_point(void**) {
  Random random(4);
  for (int trial = 0; trial < 100; ++trial) {
    Obstacle bar = capsule_obstacle(random.inside(-1, 1), random.turn().toRotationMatrix(), 0.1, 0.8);
    bar.velocity_mps = random.inside(-1, 1);
    bar.angular_velocity_radps = random.inside(-2, 2);
    const double dt_s = 1e-6;
    const Vector3 by_difference =
        (extrapolated(bar, dt_s).capsule.end - extrapolated(bar, -dt_s).capsule.end) / (2.0 * dt_s);
    check_near_because(velocity_at(bar, bar.capsule.end), by_difference, 1e-8, "trial %d", trial);
  }
}

void a_cylinder_keeps_its_size_when_it_moves_and_grows(void**) {
  test::Random random(4);
  for (int trial = 0; trial < 200; ++trial) {
    const double radius_m = random.uniform(0.01, 0.5), height_m = random.uniform(0.01, 1.0);
    Obstacle cylinder = cylinder_obstacle(random.inside(-1, 1), random.turn().toRotationMatrix(), radius_m, height_m);
    cylinder.velocity_mps = random.inside(-1, 1);
    cylinder.angular_velocity_radps = random.inside(-2, 2);
    Obstacle later = extrapolated(cylinder, 0.7);
    check_near(inflation_m(later), 0.0, 1e-12);
    later.capsule.radius_m += 0.03;
    const ConvexSolid solid = solid_of(later);
    check_near(solid.half_m, Vector3(radius_m, radius_m, height_m / 2), 1e-12);
    check_near(solid.radius_m, 0.03, 1e-12);
    check_near(solid.centre, cylinder.capsule.centre() + 0.7 * cylinder.velocity_mps, 1e-12);
  }
  assert_true(cylinder_obstacle(Vector3::Zero(), Matrix3::Identity(), 0.2, 1e-6).shape == Shape::kSphere);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_moving_sphere_moves_straight),
      cmocka_unit_test(a_quarter_turn_rotates_the_ends_about_the_centre),
      cmocka_unit_test(extrapolation_agrees_with_numerical_integration),
      cmocka_unit_test(extrapolation_by_no_time_changes_nothing),
      cmocka_unit_test(a_box_keeps_its_edges_in_any_order_and_rotates_rigidly),
      cmocka_unit_test(a_box_without_width_is_stored_as_a_capsule_and_one_without_height_as_a_box),
      cmocka_unit_test(velocity_at_a_point_is_the_derivative_of_that_point),
      cmocka_unit_test(a_cylinder_keeps_its_size_when_it_moves_and_grows),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
