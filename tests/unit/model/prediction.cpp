#include "firmware/model/prediction.h"

#include "firmware/model/proximity.h"
#include "tests/support/check.h"
#include "tests/support/lwa3.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::lwa3;
using test::Random;

namespace {

void clearance_after_a_while_is_the_exact_one_to_the_extrapolated_obstacles(void**) {
  Random random(5);
  for (int trial = 0; trial < 500; ++trial) {
    const LinkPoses poses = forward_kinematics(lwa3(), random.configuration(lwa3()));
    std::array<Obstacle, 5> obstacles;
    for (Obstacle& obstacle : obstacles) {
      const Vector3 centre = random.inside(-1, 1);
      const Matrix3 rotation = random.turn().toRotationMatrix();
      obstacle = random.chance(0.5) ? box_obstacle(centre, rotation, random.inside(0.01, 0.5))
                                    : capsule_obstacle(centre, rotation, random.uniform(0.01, 0.1), 0.4);
      obstacle.velocity_mps = random.inside(-0.3, 0.3);
      obstacle.angular_velocity_radps = random.inside(-1, 1);
    }
    const double after_s = random.uniform(0, 3), enough_m = random.uniform(0.02, 1.0);
    double least_m = enough_m;
    for (const Obstacle& obstacle : obstacles)
      for (const LinkShape& shape : lwa3().shapes)
        if (shape.body > 0)
          least_m =
              std::min(least_m, measure_pair(transformed(poses, shape), extrapolated(obstacle, after_s)).distance_m);
    check_near(clearance_after(lwa3(), poses, obstacles.data(), 5, after_s, enough_m), least_m, 1e-12);
  }
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(clearance_after_a_while_is_the_exact_one_to_the_extrapolated_obstacles),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
