#include "firmware/foresight/person_proximity.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "firmware/model/nearest_points.h"
#include "tests/support/check.h"
#include "tests/support/lwa3.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::lwa3;
using test::Random;

namespace {

/// Spheres and capsules about the arm.
std::vector<Obstacle> random_obstacles(Random& random, Kind kind) {
  std::vector<Obstacle> obstacles;
  for (int i = 0; i < 4; ++i) {
    const Vector3 centre = random.inside(-1.0, 1.0);
    const double radius_m = random.uniform(0.03, 0.15);
    obstacles.push_back(i % 2 ? sphere_obstacle(centre, radius_m)
                              : capsule_obstacle(centre, random.turn().toRotationMatrix(), radius_m, 0.4));
    obstacles.back().kind = kind;
  }
  return obstacles;
}

double proximity(const LinkPoses& poses, const std::vector<Obstacle>& obstacles) {
  return person_proximity(poses, obstacles.data(), static_cast<int>(obstacles.size()));
}

/// The mean along the arm, by points at distances of about 1 mm.
double by_many_points(const LinkPoses& poses, const std::vector<Obstacle>& obstacles) {
  double sum = 0.0, count = 0.0;
  for (size_t body = 1; body <= 7; ++body) {
    const Vector3 start = poses.origin[body], end = body < 7 ? poses.origin[body + 1] : poses.tool_position;
    const int points = static_cast<int>(1000.0 * (end - start).norm());
    for (int i = 0; i < points; ++i) {
      const Vector3 point = start + (i + 0.5) / points * (end - start);
      double least_m = 1e9;
      for (const Obstacle& obstacle : obstacles) {
        const Capsule& capsule = obstacle.capsule;
        const Vector3 nearest = nearest_on_segment(capsule.start, capsule.end, point);
        least_m = std::min(least_m, (nearest - point).norm() - capsule.radius_m);
      }
      sum += std::exp(-std::max(0.0, least_m) / 0.2);
      count += 1.0;
    }
  }
  return sum / count;
}

void it_is_the_mean_along_the_arm(void**) {
  Random random(1);
  for (int trial = 0; trial < 200; ++trial) {
    const LinkPoses poses = forward_kinematics(lwa3(), random.configuration(lwa3(), 1.0));
    const std::vector<Obstacle> persons = random_obstacles(random, Kind::kPerson);
    check_near_because(proximity(poses, persons), by_many_points(poses, persons), 0.06, "trial %d", trial);
  }
}

void things_do_not_count(void**) {
  Random random(2);
  const LinkPoses poses = forward_kinematics(lwa3(), test::home_rad());
  std::vector<Obstacle> obstacles = random_obstacles(random, Kind::kThing);
  check_near(proximity(poses, obstacles), 0.0, 0.0);
  check_near(proximity(poses, {}), 0.0, 0.0);
  obstacles[1].kind = Kind::kPerson;
  check_near(proximity(poses, obstacles), proximity(poses, {obstacles[1]}), 0.0);
}

void it_grows_from_0_to_1_as_a_person_comes_nearer(void**) {
  const LinkPoses poses = forward_kinematics(lwa3(), test::home_rad());
  double last = -1.0;
  for (double away_m = 10.0; away_m > 0.0; away_m -= 0.2) {
    Obstacle person = sphere_obstacle(Vector3(12.0, 0.0, 0.7), 11.0 - away_m);
    person.kind = Kind::kPerson;
    const double now = proximity(poses, {person});
    check(now > last && now <= 1.0, "%g m away: %g after %g", away_m, now, last);
    last = now;
  }
  Obstacle everywhere = sphere_obstacle(Vector3(0, 0, 0.7), 3.0);
  everywhere.kind = Kind::kPerson;
  check_near(proximity(poses, {everywhere}), 1.0, 1e-12);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(it_is_the_mean_along_the_arm),
      cmocka_unit_test(things_do_not_count),
      cmocka_unit_test(it_grows_from_0_to_1_as_a_person_comes_nearer),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
