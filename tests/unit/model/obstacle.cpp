#include "firmware/model/obstacle.h"

#include "tests/support/check.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::Random;

namespace {

void a_moving_sphere_goes_straight(void**) {
  Obstacle sphere;
  sphere.capsule = {Vector3(1, 2, 3), Vector3(1, 2, 3), 0.1};
  sphere.velocity_mps = Vector3(0.5, -1, 2);
  sphere.angular_velocity_radps = Vector3(9, 9, 9);
  const Capsule later = extrapolated(sphere, 0.5).capsule;
  check_near(later.start, Vector3(1.25, 1.5, 4), 1e-15);
  check_near(later.end, Vector3(1.25, 1.5, 4), 1e-15);
  check_near(later.radius_m, 0.1, 0);
}

void a_quarter_turn_carries_the_ends_around_the_middle(void**) {
  Obstacle bar;
  bar.capsule = {Vector3(1, 0, 0), Vector3(3, 0, 0), 0.1};
  bar.velocity_mps = Vector3(0, 0, 1);
  bar.angular_velocity_radps = Vector3(0, 0, M_PI);
  const Capsule later = extrapolated(bar, 0.5).capsule;
  check_near(later.start, Vector3(2, -1, 0.5), 1e-15);
  check_near(later.end, Vector3(2, 1, 0.5), 1e-15);
}

/// The end points obey p' = v + w x (p - centre); small steps of it must lead to the same place.
void motion_agrees_with_small_steps(void**) {
  Random random(1);
  for (int trial = 0; trial < 50; ++trial) {
    Obstacle bar;
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

void no_time_changes_nothing(void**) {
  Random random(2);
  Obstacle bar;
  bar.capsule = {random.inside(-1, 1), random.inside(-1, 1), 0.1};
  bar.velocity_mps = random.inside(-1, 1);
  bar.angular_velocity_radps = random.inside(-2, 2);
  check_near(extrapolated(bar, 0.0).capsule.start, bar.capsule.start, 0);
  check_near(extrapolated(bar, 0.0).capsule.end, bar.capsule.end, 0);
}

void a_box_keeps_its_edges_however_they_are_ordered_and_turns_as_one(void**) {
  Random random(3);
  for (int trial = 0; trial < 200; ++trial) {
    const Quaternion turn = random.turn();
    const Vector3 centre = random.inside(-1, 1), edges = random.inside(0.01, 1);
    Obstacle obstacle = box_obstacle(centre, turn.toRotationMatrix(), edges);
    obstacle.angular_velocity_radps = random.inside(-2, 2);
    const double dt_s = random.uniform(0, 1), angle = obstacle.angular_velocity_radps.norm() * dt_s;
    const Eigen::AngleAxisd by(angle, obstacle.angular_velocity_radps.normalized());
    const Box later = box_of(extrapolated(obstacle, dt_s));
    // The same corners: each of the eight is one of the box's.
    for (int corner = 0; corner < 8; ++corner) {
      const Vector3 sign(corner & 1 ? 0.5 : -0.5, corner & 2 ? 0.5 : -0.5, corner & 4 ? 0.5 : -0.5);
      const Vector3 p = later.axes.transpose() * (by * (turn * sign.cwiseProduct(edges)));
      check_near_because(p.cwiseAbs().eval(), later.half_m, 1e-12, "trial %d, corner %d", trial, corner);
    }
    check_near_because(later.centre, centre, 1e-12, "trial %d", trial);
    check_near_because(inflation_m(extrapolated(obstacle, dt_s)), 0.0, 1e-12, "trial %d", trial);
  }
}

void a_box_without_width_is_a_line(void**) {
  const Obstacle line = box_obstacle(Vector3::Zero(), Matrix3::Identity(), Vector3(0, 0, 0.4));
  assert_false(line.is_box());
  check_near((line.capsule.end - line.capsule.start).norm(), 0.4, 1e-12);
  assert_true(box_obstacle(Vector3::Zero(), Matrix3::Identity(), Vector3(0.3, 0, 0.4)).is_box());
}

void velocity_at_a_point_is_how_that_point_moves(void**) {
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

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_moving_sphere_goes_straight),
      cmocka_unit_test(a_quarter_turn_carries_the_ends_around_the_middle),
      cmocka_unit_test(motion_agrees_with_small_steps),
      cmocka_unit_test(no_time_changes_nothing),
      cmocka_unit_test(a_box_keeps_its_edges_however_they_are_ordered_and_turns_as_one),
      cmocka_unit_test(a_box_without_width_is_a_line),
      cmocka_unit_test(velocity_at_a_point_is_how_that_point_moves),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
