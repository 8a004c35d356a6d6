#include "firmware/control/motion_estimator.h"

#include <memory>

#include "tests/support/allocation_count.h"
#include "tests/support/check.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::Random;

namespace {

Obstacle ball(int32_t id, const Vector3& position_m) {
  Obstacle obstacle = sphere_obstacle(position_m, 0.05);
  obstacle.id = id;
  return obstacle;
}

Obstacle limb(const Vector3& centre_m, const Vector3& half_axis_m) {
  Obstacle obstacle;
  obstacle.id = 7;
  obstacle.shape = Shape::kCapsule;
  obstacle.capsule = {centre_m - half_axis_m, centre_m + half_axis_m, 0.05};
  return obstacle;
}

/// An estimator and a sender.
struct Scene {
  std::unique_ptr<MotionEstimator> estimator = std::make_unique<MotionEstimator>();
  std::unique_ptr<ObstacleSet> set = std::make_unique<ObstacleSet>();

  /// Returns the first obstacle, completed.
  const Obstacle& send(const std::vector<Obstacle>& obstacles, double elapsed_s) {
    set->count = static_cast<int>(obstacles.size());
    std::copy(obstacles.begin(), obstacles.end(), set->obstacles.begin());
    estimator->complete(*set, elapsed_s);
    return set->obstacles[0];
  }
};

Vector3 noise(Random& random, double deviation_m) {
  const double x = random.normal(), y = random.normal(), z = random.normal();
  return deviation_m * Vector3(x, y, z);
}

void an_obstacle_that_moves_without_a_velocity_gets_its_own(void**) {
  Random random(1);
  for (const double rate_hz : {10.0, 30.0, 60.0, 100.0, 500.0}) {
    Scene scene;
    const Vector3 velocity_mps = random.uniform(0.1, 6.0) * random.direction();
    const Vector3 start_m = random.inside(-1.0, 1.0);
    double t_s = 0.0;
    Obstacle last;
    for (; t_s < 0.5; t_s += 1.0 / rate_hz) last = scene.send({ball(1, start_m + t_s * velocity_mps)}, 1.0 / rate_hz);
    check_near(last.velocity_mps, velocity_mps, 1e-6);
    check_near(last.angular_velocity_radps, Vector3::Zero(), 0.0);
  }
}

/// The chord of the circle lags: the slope is that of some 50 ms before.
void a_limb_that_turns_without_an_angular_velocity_gets_its_own_whatever_the_order_of_its_ends(void**) {
  Random random(2);
  for (const double rate_hz : {30.0, 60.0, 100.0}) {
    Scene scene;
    const Vector3 axis = random.direction(), half_axis_m = 0.2 * axis.unitOrthogonal();
    const double turn_radps = random.uniform(1.0, 4.0);
    Obstacle last;
    for (double t_s = 0.0; t_s < 0.5; t_s += 1.0 / rate_hz) {
      const Vector3 turned_m = Eigen::AngleAxisd(turn_radps * t_s, axis) * half_axis_m;
      last = scene.send({limb(Vector3(0.5, 0, 0), random.chance(0.5) ? turned_m : Vector3(-turned_m))}, 1.0 / rate_hz);
    }
    check_near(last.angular_velocity_radps.normalized(), axis, 1e-6);
    check_near(last.angular_velocity_radps.norm(), turn_radps, 0.05 * turn_radps);
    check_near(last.velocity_mps, Vector3::Zero(), 0.0);
  }
}

/// Two edges are nearly equal; which of them is the longest changes from report to report.
void a_box_at_rest_whose_longest_edge_changes_does_not_turn(void**) {
  Random random(11);
  const Matrix3 turn = random.turn().toRotationMatrix();
  for (const double rate_hz : {10.0, 30.0, 100.0}) {
    Scene scene;
    for (int k = 0; k < 60; ++k) {
      const Vector3 edges_m(0.3 + random.uniform(-0.002, 0.002), 0.3 + random.uniform(-0.002, 0.002), 0.1);
      Obstacle box = box_obstacle({0.6, 0.1, 0.2}, turn, edges_m);
      box.id = 3;
      check_near(scene.send({box}, 1.0 / rate_hz).angular_velocity_radps, Vector3::Zero(), 0.0);
    }
  }
}

void noise_does_not_move_an_obstacle_at_rest(void**) {
  Random random(3);
  for (const double deviation_m : {0.001, 0.003, 0.005, 0.01}) {
    Scene scene;
    int moving = 0;
    constexpr int kReports = 30'000, kLearning = 60;
    for (int k = 0; k < kReports; ++k) {
      const Obstacle& last = scene.send({limb(noise(random, deviation_m), Vector3(0, 0, 0.2))}, 1.0 / 30.0);
      moving += k >= kLearning && !last.velocity_mps.isZero(0.0);
    }
    check(moving < kReports / 200, "%g m: %d of %d reports move", deviation_m, moving, kReports);
  }
}

void the_velocity_of_a_noisy_obstacle_is_right_on_average_and_its_error_is_bounded(void**) {
  Random random(4);
  const Vector3 velocity_mps(1.0, -0.5, 0.2);
  Vector3 sum_mps = Vector3::Zero();
  double error2 = 0.0;
  int count = 0;
  for (int trial = 0; trial < 200; ++trial) {
    Scene scene;
    for (int k = 0; k < 20; ++k) {
      const Obstacle& last = scene.send({ball(1, k / 30.0 * velocity_mps + noise(random, 0.01))}, 1.0 / 30.0);
      if (k < 4) continue;
      sum_mps += last.velocity_mps;
      error2 += (last.velocity_mps - velocity_mps).squaredNorm();
      ++count;
    }
  }
  check_near(Vector3(sum_mps / count), velocity_mps, 0.03);
  // Four reports 1/30 s apart: the slope of a coordinate deviates by 10 mm / (1/30 s sqrt 5) = 0.134 m/s.
  check_near(std::sqrt(error2 / count), 0.134 * std::sqrt(3.0), 0.03);
}

void a_constant_reported_velocity_is_not_changed(void**) {
  Scene scene;
  for (int k = 0; k < 20; ++k) {
    Obstacle reported = limb(Vector3(0.02 * k, 0, 0), Vector3(0, 0, 0.2));
    reported.velocity_mps = Vector3(0, 0.3, 0);
    reported.angular_velocity_radps = Vector3(0, 0, 0.4);
    const Obstacle& last = scene.send({reported}, 0.02);
    check_near(last.velocity_mps, reported.velocity_mps, 0.0);
    check_near(last.angular_velocity_radps, reported.angular_velocity_radps, 0.0);
  }
}

void a_reported_velocity_that_changes_is_led_by_its_change_in_a_fifth_of_a_second(void**) {
  Random random(6);
  constexpr double kLead_s = 0.2, kLargest_mps = 0.5;
  for (const double rate_hz : {30.0, 60.0, 100.0, 200.0}) {
    for (const double size_mps2 : {0.5, 2.0, 10.0}) {
      Scene scene;
      const Vector3 start_mps = random.inside(-0.3, 0.3), acceleration_mps2 = size_mps2 * random.direction();
      Vector3 lead = Vector3::Zero();
      for (int k = 0; k < 0.5 * rate_hz; ++k) {
        const double t_s = k / rate_hz;
        Obstacle reported = ball(1, t_s * start_mps + 0.5 * t_s * t_s * acceleration_mps2);
        reported.velocity_mps = start_mps + t_s * acceleration_mps2;
        const Obstacle& last = scene.send({reported}, 1.0 / rate_hz);
        lead = last.velocity_mps - reported.velocity_mps;
        check_near(last.lead_mps, lead, 1e-12);
      }
      check_near(lead, std::min(kLead_s, kLargest_mps / size_mps2) * acceleration_mps2, 1e-6);
    }
  }
}

void a_reported_velocity_is_led_before_the_obstacle_has_left_its_place(void**) {
  Scene scene;
  Obstacle last;
  double x_m = 0.0;
  for (int k = 0; k <= 120; ++k) {  // creeps for 1 s, then accelerates by 0.5 m/s2 for 0.2 s
    Obstacle reported = ball(1, Vector3(x_m, 0, 0));
    reported.velocity_mps = Vector3(0.01 + 0.005 * std::max(0, k - 100), 0, 0);
    x_m += 0.01 * reported.velocity_mps.x();
    last = scene.send({reported}, 0.01);
  }
  check_near(last.velocity_mps, Vector3(0.01 + 0.1 + 0.2 * 0.5, 0, 0), 0.005);
}

/// A camera's: finite differences of noisy positions over 0.1 s, of an obstacle at rest and of one that moves.
void noise_of_a_reported_velocity_leads_it_seldom(void**) {
  Random random(7);
  for (const auto& [speed_mps, deviation_m] : {std::pair{0.5, 0.005}, {0.5, 0.01}, {0.0, 0.005}, {0.0, 0.01}}) {
    const Vector3 velocity_mps(speed_mps, 0, 0);
    double lead2 = 0.0, error2 = 0.0;
    int led = 0, count = 0;
    for (int trial = 0; trial < 20; ++trial) {
      Scene scene;
      std::vector<Vector3> positions_m;
      for (int k = 0; k < 300; ++k) {
        positions_m.push_back(k / 30.0 * velocity_mps + noise(random, deviation_m));
        if (k < 3) continue;
        Obstacle reported = ball(1, positions_m.back());
        reported.velocity_mps = (positions_m[k] - positions_m[k - 3]) / 0.1;
        const Vector3 lead = scene.send({reported}, 1.0 / 30.0).velocity_mps - reported.velocity_mps;
        lead2 += lead.squaredNorm();
        error2 += (reported.velocity_mps - velocity_mps).squaredNorm();
        led += !lead.isZero(0.0);
        ++count;
      }
    }
    check(led < 0.01 * count, "%g m/s, %g m: %d of %d velocities are led", speed_mps, deviation_m, led, count);
    check(lead2 < 0.01 * error2, "%g m/s, %g m: lead %g m/s, noise %g m/s", speed_mps, deviation_m,
          std::sqrt(lead2 / count), std::sqrt(error2 / count));
  }
}

void an_obstacle_that_stops_rests(void**) {
  Scene scene;
  double resting_s = 0.0;
  for (int k = 0; k < 200; ++k) {
    const Obstacle& last = scene.send({ball(1, Vector3(0.01 * std::min(k, 50), 0, 0))}, 0.01);
    if (k > 50 && last.velocity_mps.norm() > 1e-9) resting_s = 0.01 * (k - 50);
  }
  check(resting_s < 0.3, "still moves after %g s", resting_s);
}

void another_obstacle_under_the_same_id_begins_anew(void**) {
  Scene scene;
  for (int k = 0; k < 20; ++k) scene.send({ball(1, Vector3(0.02 * k, 0, 0))}, 0.02);
  check_near(scene.send({ball(1, Vector3(0, 1, 0))}, 0.02).velocity_mps, Vector3::Zero(), 0.0);
  check_near(scene.send({ball(1, Vector3(0, 1, 0))}, 0.02).velocity_mps, Vector3::Zero(), 0.0);
}

void obstacles_are_matched_by_id_and_those_of_one_id_by_their_order(void**) {
  Scene scene;
  for (int k = 0; k < 20; ++k) {
    const double s_m = 0.02 * k;
    const Obstacle east = ball(1, Vector3(s_m, 0, 0)), north = ball(2, Vector3(0, s_m, 0)),
                   up = ball(2, Vector3(1, 1, s_m));
    scene.send(k % 2 == 0 ? std::vector{north, east, up} : std::vector{east, north, up}, 0.02);
  }
  check_near(scene.set->obstacles[0].velocity_mps, Vector3(1, 0, 0), 1e-6);
  check_near(scene.set->obstacles[1].velocity_mps, Vector3(0, 1, 0), 1e-6);
  check_near(scene.set->obstacles[2].velocity_mps, Vector3(0, 0, 1), 1e-6);
}

void two_senders_may_alternate(void**) {
  Scene scene;
  Obstacle first, second;
  for (int k = 0; k < 20; ++k) {
    first = scene.send({ball(1, Vector3(0.03 * k, 0, 0))}, 0.015);
    second = scene.send({ball(2, Vector3(0, 0.03 * k, 0)), ball(3, Vector3::Zero())}, 0.015);
  }
  check_near(first.velocity_mps, Vector3(1, 0, 0), 1e-6);
  check_near(second.velocity_mps, Vector3(0, 1, 0), 1e-6);
}

void reports_at_one_instant_or_of_a_bad_clock_give_finite_velocities(void**) {
  Random random(5);
  Scene scene;
  for (int k = 0; k < 10'000; ++k) {
    const double elapsed_s = random.chance(0.3) ? 0.0 : std::pow(10.0, random.uniform(-9.0, 3.0));
    const Obstacle& last = scene.send({limb(random.inside(-1.0, 1.0), random.inside(-0.2, 0.2))}, elapsed_s);
    assert_true(last.velocity_mps.allFinite() && last.angular_velocity_radps.allFinite());
    check(last.velocity_mps.norm() < 20.0, "%g m/s", last.velocity_mps.norm());
  }
}

Obstacle hand(const Vector3& position_m) {
  Obstacle person = ball(1, position_m);
  person.kind = Kind::kPerson;
  return person;
}

/// Also if it swings by 0.15 m once a second, as seen by a camera. Few reports a second lower it.
void the_mean_velocity_of_a_walker_is_that_of_its_body(void**) {
  Random random(6);
  for (const double rate_hz : {10.0, 30.0, 60.0, 100.0}) {
    for (const double swing_m : {0.0, 0.15}) {
      Scene scene;
      const Vector3 velocity_mps(1.3, 0, 0);
      Vector3 sum_mps = Vector3::Zero();
      int reports = 0;
      for (double t_s = 0.0; t_s < 4.0; t_s += 1.0 / rate_hz) {
        const double swing = swing_m * std::sin(2.0 * M_PI * t_s);
        const Vector3 position_m = (t_s + swing / 1.3) * velocity_mps + noise(random, 0.007);
        const Vector3 mean_mps = scene.send({hand(position_m)}, 1.0 / rate_hz).mean_velocity_mps;
        if (t_s < 2.0) continue;
        check_near(mean_mps, velocity_mps, 0.1 + 2.2 * swing_m + 1.3 / rate_hz);
        sum_mps += mean_mps;
        ++reports;
      }
      check_near(Vector3(sum_mps / reports), velocity_mps, 0.06 + 1.3 / rate_hz);
    }
  }
}

void one_who_stands_or_is_no_person_has_no_mean_velocity(void**) {
  Random random(7);
  Scene standing, thing;
  for (double t_s = 0.0; t_s < 4.0; t_s += 1.0 / 30.0) {
    check_near(standing.send({hand(noise(random, 0.01))}, 1.0 / 30.0).mean_velocity_mps, Vector3::Zero(), 0.0);
    check_near(thing.send({ball(1, Vector3(t_s, 0, 0))}, 1.0 / 30.0).mean_velocity_mps, Vector3::Zero(), 0.0);
  }
}

void a_thing_that_becomes_a_person_has_no_mean_velocity_at_first(void**) {
  Scene scene;
  const Vector3 place_m(1, 2, 1);
  for (double t_s = 0.0; t_s < 1.0; t_s += 0.02) scene.send({ball(1, place_m)}, 0.02);
  for (double t_s = 0.0; t_s < 1.0; t_s += 0.02)
    check_near(scene.send({hand(place_m)}, 0.02).mean_velocity_mps, Vector3::Zero(), 0.0);
}

void another_person_under_the_same_id_has_no_mean_velocity(void**) {
  Scene scene;
  for (double t_s = 0.0; t_s < 2.0; t_s += 0.02) scene.send({hand(Vector3(t_s, 0, 0))}, 0.02);
  check_near(scene.send({hand(Vector3(-1.0, 0, 0))}, 0.02).mean_velocity_mps, Vector3::Zero(), 0.0);
}

void nothing_is_allocated_for_the_largest_set(void**) {
  Scene scene;
  std::vector<Obstacle> all;
  for (int i = 0; i < kMaxObstacles; ++i) all.push_back(ball(i % 1000, Vector3(0.001 * i, 0, 0)));
  scene.send(all, 0.03);
  const int64_t before = test::allocation_count();
  scene.estimator->complete(*scene.set, 0.03);
  assert_int_equal(test::allocation_count(), before);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(an_obstacle_that_moves_without_a_velocity_gets_its_own),
      cmocka_unit_test(a_limb_that_turns_without_an_angular_velocity_gets_its_own_whatever_the_order_of_its_ends),
      cmocka_unit_test(a_box_at_rest_whose_longest_edge_changes_does_not_turn),
      cmocka_unit_test(noise_does_not_move_an_obstacle_at_rest),
      cmocka_unit_test(the_velocity_of_a_noisy_obstacle_is_right_on_average_and_its_error_is_bounded),
      cmocka_unit_test(a_constant_reported_velocity_is_not_changed),
      cmocka_unit_test(a_reported_velocity_that_changes_is_led_by_its_change_in_a_fifth_of_a_second),
      cmocka_unit_test(a_reported_velocity_is_led_before_the_obstacle_has_left_its_place),
      cmocka_unit_test(noise_of_a_reported_velocity_leads_it_seldom),
      cmocka_unit_test(an_obstacle_that_stops_rests),
      cmocka_unit_test(another_obstacle_under_the_same_id_begins_anew),
      cmocka_unit_test(obstacles_are_matched_by_id_and_those_of_one_id_by_their_order),
      cmocka_unit_test(two_senders_may_alternate),
      cmocka_unit_test(reports_at_one_instant_or_of_a_bad_clock_give_finite_velocities),
      cmocka_unit_test(the_mean_velocity_of_a_walker_is_that_of_its_body),
      cmocka_unit_test(one_who_stands_or_is_no_person_has_no_mean_velocity),
      cmocka_unit_test(a_thing_that_becomes_a_person_has_no_mean_velocity_at_first),
      cmocka_unit_test(another_person_under_the_same_id_has_no_mean_velocity),
      cmocka_unit_test(nothing_is_allocated_for_the_largest_set),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
