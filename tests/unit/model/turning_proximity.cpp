#include "firmware/model/turning_proximity.h"

#include "tests/support/check.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::Random;

namespace {

const LinkPoses kNoJoints{};

struct Rod {
  LinkShape shape{};
  Capsule capsule;
  PosedShape posed{shape, kNoJoints, capsule};

  Rod(const Vector3& start, const Vector3& end, double radius_m) : capsule{start, end, radius_m} {}
};

void a_rod_that_tilts_above_a_table_meets_it_with_its_other_end(void**) {
  const Obstacle table = box_obstacle({0, 0, -0.05}, Matrix3::Identity(), {2.0, 2.0, 0.1});
  const Rod rod({-0.5, 0, 0.10}, {0.5, 0, 0.12}, 0.03);  // the left end is nearest
  Proximity now = measure_pair(rod.capsule, table);
  now.shape = 3;
  now.obstacle = 7;
  check_near(now.on_arm.x(), -0.5, 1e-9);
  const auto next = proximities_after_turn(rod.posed, table, now, {0, 0.3, 0});  // the right end falls
  assert_true(next.size() >= 1);
  check_near(next[0].on_arm.x(), 0.5, 1e-9);
  check_near(next[0].distance_m, 0.09, 1e-9);
  check_near(next[0].normal.z(), 1.0, 1e-9);
  assert_int_equal(next[0].shape, 3);
  assert_int_equal(next[0].obstacle, 7);
  for (const Proximity& pair : proximities_after_turn(rod.posed, table, now, {0, -0.3, 0}))  // the right end rises
    check(pair.on_obstacle.x() < -0.99, "%g", pair.on_obstacle.x());  // only the left edge of the table counts
}

void a_rod_that_tilts_above_two_edges_of_a_box_meets_the_other_edge(void**) {
  const Obstacle block = box_obstacle({0, 0, -0.05}, Matrix3::Identity(), {0.4, 0.3, 0.1});
  const Rod rod({-1.0, 0, 0.08}, {1.0, 0, 0.12}, 0.03);
  const Proximity now = measure_pair(rod.capsule, block);
  check(now.on_obstacle.x() < -0.19, "%g", now.on_obstacle.x());
  const auto next = proximities_after_turn(rod.posed, block, now, {0, 0.3, 0});
  assert_int_equal(next.size(), 2);
  check_near(next[1].on_obstacle.x(), 0.2, 1e-9);
  check_near(next[1].on_obstacle.z(), 0.0, 1e-9);
  check(next[1].on_arm.x() > 0.19 && next[1].on_arm.x() < 0.21, "%g", next[1].on_arm.x());
}

/// A quarter of a second later, the distance is the least of those of the present nearest points and of the next ones,
/// each moved with its body: no other point of either core comes nearer.
void the_points_are_those_that_come_nearest(void**) {
  Random random(1);
  double worst_m = 0.0, worst_without_m = 0.0;
  for (int trial = 0; trial < 2000; ++trial) {
    const Vector3 middle = random.inside(-0.5, 0.5), half = 0.3 * random.direction();
    const Rod rod(middle - half, middle + half, random.uniform(0.02, 0.08));
    const Vector3 centre = middle + random.direction() * random.uniform(0.2, 0.6);
    const Obstacle obstacle = random.chance(0.5)
                                  ? capsule_obstacle(centre, random.turn().toRotationMatrix(), 0.05, 0.6)
                                  : box_obstacle(centre, random.turn().toRotationMatrix(), {0.6, 0.5, 0.2});
    const Proximity now = measure_pair(rod.capsule, obstacle);
    if (now.distance_m < 0.02) continue;
    const Vector3 turn_rad = random.direction() * random.uniform(0.0, 0.2);
    const Matrix3 turn = Eigen::AngleAxisd(turn_rad.norm(), turn_rad.normalized()).toRotationMatrix();
    const auto later = [&](const Vector3& point) { return Vector3(now.on_arm + turn * (point - now.on_arm)); };
    const Capsule turned{later(rod.capsule.start), later(rod.capsule.end), rod.capsule.radius_m};
    const double true_m = measure_pair(turned, obstacle).distance_m;
    double predicted_m = now.distance_m;
    for (const Proximity& pair : proximities_after_turn(rod.posed, obstacle, now, turn_rad)) {
      const double moved_m = pair.normal.dot(later(pair.on_arm) - pair.on_arm);
      predicted_m = std::min(predicted_m, pair.distance_m + moved_m);
    }
    worst_m = std::max(worst_m, predicted_m - true_m);
    worst_without_m = std::max(worst_without_m, now.distance_m - true_m);
  }
  print_message("predicted too far by at most %.1f mm, by the nearest points alone by %.1f mm\n", 1e3 * worst_m,
                1e3 * worst_without_m);
  assert_true(worst_m < 0.5 * worst_without_m);
}

/// A capsule as a link and the same capsule as an obstacle are met alike.
void another_link_is_met_like_an_obstacle_of_its_shape(void**) {
  Random random(2);
  int seen = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    const Vector3 middle = random.inside(-0.5, 0.5), half = 0.3 * random.direction();
    const Rod rod(middle - half, middle + half, random.uniform(0.02, 0.08));
    const Vector3 centre = middle + random.direction() * random.uniform(0.2, 0.6);
    const Obstacle obstacle = capsule_obstacle(centre, random.turn().toRotationMatrix(), 0.05, 0.6);
    const Rod other(obstacle.capsule.start, obstacle.capsule.end, 0.05);
    const Proximity now = measure_pair(rod.capsule, obstacle);
    if (now.distance_m < 0.02) continue;
    const Vector3 turn_rad = random.direction() * random.uniform(0.0, 0.5);
    const auto expected = proximities_after_turn(rod.posed, obstacle, now, turn_rad);
    const auto found = proximities_after_turn(rod.posed, other.posed, now, turn_rad);
    assert_int_equal(found.size(), expected.size());
    for (int i = 0; i < found.size(); ++i) {
      check_near(found[i].distance_m, expected[i].distance_m, 1e-9);
      check_near(found[i].normal, expected[i].normal, 1e-6);
      check_near(found[i].on_arm, expected[i].on_arm, 1e-6);
      check_near(found[i].on_obstacle, expected[i].on_obstacle, 1e-6);
      ++seen;
    }
  }
  check(seen > 300, "%d", seen);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_rod_that_tilts_above_a_table_meets_it_with_its_other_end),
      cmocka_unit_test(a_rod_that_tilts_above_two_edges_of_a_box_meets_the_other_edge),
      cmocka_unit_test(the_points_are_those_that_come_nearest),
      cmocka_unit_test(another_link_is_met_like_an_obstacle_of_its_shape),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
