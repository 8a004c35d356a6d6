#include "firmware/model/prediction.h"

#include "firmware/model/proximity.h"
#include "tests/support/check.h"
#include "tests/support/lwa3.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::lwa3;
using test::Random;

namespace {

/// A capsule that moves, turns and walks.
void a_person_keeps_its_velocity_for_300_ms_then_walks_until_2_s_and_rests(void**) {
  Obstacle obstacle = capsule_obstacle(Vector3(1, 2, 3), Matrix3::Identity(), 0.05, 0.4);
  obstacle.velocity_mps = Vector3(0.1, 0, 0);
  obstacle.angular_velocity_radps = Vector3(0, 2.0, 0);
  obstacle.mean_velocity_mps = Vector3(0, 0.5, 0);
  for (const double after_s : {0.0, 0.1, 0.3, 0.5, 2.0, 4.0}) {
    for (const Kind kind : {Kind::kThing, Kind::kPerson}) {
      obstacle.kind = kind;
      const Obstacle then = predicted_obstacle(obstacle, after_s);
      const double moving_s = kind == Kind::kPerson ? std::min(after_s, 0.3) : after_s, turn_rad = 2.0 * moving_s;
      const double walking_s = kind == Kind::kPerson ? std::min(1.7, std::max(0.0, after_s - 0.3)) : 0.0;
      const Vector3 half_m = 0.2 * Vector3(std::sin(turn_rad), 0, std::cos(turn_rad));
      const Vector3 centre_m = Vector3(1 + 0.1 * moving_s, 2 + 0.5 * walking_s, 3);
      check_near(then.capsule.start, centre_m - half_m, 1e-12);
      check_near(then.capsule.end, centre_m + half_m, 1e-12);
    }
  }
}

/// With the velocity that it had, a person loses the lead of that velocity.
void a_lead_lasts_as_long_as_the_velocity_that_it_is_part_of(void**) {
  for (const double after_s : {0.0, 0.2, 0.3, 0.31, 1.0, 3.0}) {
    for (const Kind kind : {Kind::kThing, Kind::kPerson}) {
      Obstacle obstacle = sphere_obstacle(Vector3(1, 2, 3), 0.05);
      obstacle.kind = kind;
      obstacle.velocity_mps = Vector3(0.5, 0, 0);
      obstacle.lead_mps = Vector3(0.3, 0, 0);
      advance(obstacle, 0.01, after_s);
      const bool has_turned = kind == Kind::kPerson && after_s > 0.3;
      check_near(obstacle.lead_mps, Vector3(has_turned ? 0.0 : 0.3, 0, 0), 0.0);
      check_near(obstacle.velocity_mps, Vector3(has_turned ? 0.0 : 0.5, 0, 0), 0.0);
    }
  }
}

void clearance_after_a_while_is_the_exact_one_to_the_predicted_obstacles(void**) {
  Random random(5);
  for (int trial = 0; trial < 1000; ++trial) {
    const bool predicts_persons = trial % 2 > 0;
    const LinkPoses poses = forward_kinematics(lwa3(), random.configuration(lwa3()));
    std::array<Obstacle, 5> obstacles;
    for (Obstacle& obstacle : obstacles) {
      const Vector3 centre = random.inside(-1, 1);
      const Matrix3 rotation = random.turn().toRotationMatrix();
      obstacle = random.chance(0.5) ? box_obstacle(centre, rotation, random.inside(0.01, 0.5))
                                    : capsule_obstacle(centre, rotation, random.uniform(0.01, 0.1), 0.4);
      if (random.chance(0.3)) obstacle = sphere_obstacle(centre, random.uniform(0.01, 0.1));
      obstacle.velocity_mps = random.inside(-0.3, 0.3);
      obstacle.angular_velocity_radps = random.inside(-1, 1);
    }
    for (Obstacle& obstacle : obstacles) {
      if (random.chance(0.5)) obstacle.kind = Kind::kPerson;
      obstacle.mean_velocity_mps = random.inside(-0.3, 0.3);
    }
    const double after_s = random.uniform(0, 3), enough_m = random.uniform(0.02, 1.0);
    double least_m = enough_m;
    for (const Obstacle& obstacle : obstacles) {
      const Obstacle then = predicts_persons ? predicted_obstacle(obstacle, after_s) : extrapolated(obstacle, after_s);
      for (const LinkShape& shape : lwa3().shapes)
        if (shape.body > 0) least_m = std::min(least_m, measure_pair(transformed(poses, shape), then).distance_m);
    }
    check_near(clearance_after(lwa3(), poses, obstacles.data(), 5, after_s, enough_m, nullptr, predicts_persons),
               least_m, 1e-12);
  }
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_person_keeps_its_velocity_for_300_ms_then_walks_until_2_s_and_rests),
      cmocka_unit_test(a_lead_lasts_as_long_as_the_velocity_that_it_is_part_of),
      cmocka_unit_test(clearance_after_a_while_is_the_exact_one_to_the_predicted_obstacles),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
