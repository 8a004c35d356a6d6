// Clearances of an arm whose links are boxes and cylinders, against GJK over all pairs without any bound.
#include "firmware/model/link_proximity.h"

#include <algorithm>
#include <memory>

#include "firmware/model/clearance.h"
#include "firmware/model/load/load_arm.h"
#include "firmware/model/prediction.h"
#include "tests/support/check.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::Random;

namespace {

const Arm& arm8() {
  static const Arm arm = load_arm("tests/data/arm8.urdf", "mount", "flange");
  return arm;
}

Obstacle random_obstacle(Random& random) {
  const Vector3 centre = random.inside(-1.2, 1.2);
  const Matrix3 rotation = random.turn().toRotationMatrix();
  const int kind = random.index(3);
  Obstacle obstacle = kind == 0   ? sphere_obstacle(centre, random.uniform(0.01, 0.1))
                      : kind == 1 ? capsule_obstacle(centre, rotation, 0.05, random.uniform(0.05, 0.5))
                                  : box_obstacle(centre, rotation, random.inside(0.01, 0.5));
  obstacle.velocity_mps = random.chance(0.3) ? Vector3(Vector3::Zero()) : random.inside(-1, 1);
  return obstacle;
}

double exact_m(const LinkPoses& poses, int shape, const Obstacle& obstacle) {
  const ConvexSolid link = solid_of(poses, arm8().shapes[static_cast<size_t>(shape)]), other = solid_of(obstacle);
  return gap_between(link, other, link.centre - other.centre).distance_m;
}

struct Scene {
  std::unique_ptr<ObstacleSet> set = std::make_unique<ObstacleSet>();
  LinkPoses poses;
  ObstacleView view{set.get(), 0.0, 0.0};

  explicit Scene(Random& random) : poses(forward_kinematics(arm8(), random.configuration(arm8()))) {
    set->count = 12;
    for (int i = 0; i < set->count; ++i) set->obstacles[static_cast<size_t>(i)] = random_obstacle(random);
  }
};

void the_arm_has_solids_that_are_no_capsules(void**) {
  const auto count = [](CoreKind kind) {
    return std::count_if(arm8().shapes.begin(), arm8().shapes.end(),
                         [&](const LinkShape& shape) { return !shape.is_capsule && shape.solid.kind == kind; });
  };
  assert_true(count(CoreKind::kBox) > 0 && count(CoreKind::kCylinder) > 0);
}

void the_nearest_pair_is_exact(void**) {
  Random random(1);
  for (int trial = 0; trial < 200; ++trial) {
    const Scene scene(random);
    double least_m = 1e9;
    for (int o = 0; o < scene.set->count; ++o)
      for (int s = 0; s < static_cast<int>(arm8().shapes.size()); ++s)
        least_m = std::min(least_m, exact_m(scene.poses, s, scene.view.at(o)));
    const Clearance clearance = measure_clearance(arm8(), scene.poses, scene.view, {0.4, 0.5});
    if (least_m > 0.0) check_near_because(clearance.nearest.distance_m, least_m, 1e-7, "trial %d", trial);
  }
}

void near_pairs_are_exact_within_4_cm_and_never_farther_than_exact(void**) {
  Random random(2);
  int exact = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const Scene scene(random);
    for (const NearPair& pair : measure_clearance(arm8(), scene.poses, scene.view, {0.4, 0.5}).near) {
      const Obstacle& obstacle = scene.view.at(pair.now.obstacle);
      const double distance_m = exact_m(scene.poses, pair.now.shape, obstacle);
      check(distance_m <= 0.0 || pair.now.distance_m <= distance_m + 1e-7, "trial %d: %g, exact %g", trial,
            pair.now.distance_m, distance_m);
      const Capsule capsule = transformed(scene.poses, arm8().shapes[static_cast<size_t>(pair.now.shape)]);
      if (distance_m <= 0.0 || measure_pair(capsule, obstacle).distance_m > kExact_m) continue;
      check_near_because(pair.now.distance_m, distance_m, 1e-7, "trial %d", trial);
      ++exact;
    }
  }
  check(exact > 30, "only %d", exact);
}

/// A sphere that moves past a link: from one millimetre to the next the distance changes by no more than two.
void the_distance_has_no_jumps(void**) {
  Random random(3);
  for (int trial = 0; trial < 100; ++trial) {
    const LinkPoses poses = forward_kinematics(arm8(), random.configuration(arm8()));
    const int shape = random.index(static_cast<int>(arm8().shapes.size()));
    const LinkShape& link = arm8().shapes[static_cast<size_t>(shape)];
    const Capsule capsule = transformed(poses, link);
    const Vector3 start = capsule.centre() + 0.4 * random.direction(), step = 1e-3 * random.direction();
    double before_m = 0.0;
    for (int i = 0; i < 800; ++i) {
      const Vector3 centre = start + i * step;
      const Obstacle sphere = sphere_obstacle(centre, 0.02);
      const Proximity pair = refined(PosedShape{link, poses, capsule}, solid_of(sphere), measure_pair(capsule, sphere));
      check_near_because(pair.normal.norm(), 1.0, 1e-9, "trial %d", trial);
      if (i > 0) check_near_because(pair.distance_m, before_m, 3e-3, "trial %d, step %d", trial, i);
      before_m = pair.distance_m;
    }
  }
}

void the_closest_approach_is_no_farther_than_the_exact_distance_on_the_way(void**) {
  Random random(4);
  int seen = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const Scene scene(random);
    for (const NearPair& pair : measure_clearance(arm8(), scene.poses, scene.view, {0.4, 0.5}).near) {
      if (pair.now.distance_m <= 0.0 || pair.approach.time_s <= 0.0 || pair.approach.head_on) continue;
      Obstacle then = scene.view.at(pair.now.obstacle);
      if (then.shape != Shape::kSphere) continue;
      for (int i = 0; i <= 20; ++i) {
        const Obstacle later = extrapolated(then, i * 0.5 / 20);
        const double distance_m = exact_m(scene.poses, pair.now.shape, later);
        if (distance_m <= 0.0) break;
        check(pair.approach.distance_m <= distance_m + 1e-3, "trial %d: %g, exact %g", trial, pair.approach.distance_m,
              distance_m);
        ++seen;
      }
    }
  }
  check(seen > 1000, "only %d", seen);
}

void the_clearance_of_a_prediction_is_exact(void**) {
  Random random(5);
  int seen = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const Scene scene(random);
    double least_m = 0.05;
    for (int o = 0; o < scene.set->count; ++o)
      for (int s = 0; s < static_cast<int>(arm8().shapes.size()); ++s)
        if (arm8().shapes[static_cast<size_t>(s)].body > 0)
          least_m = std::min(least_m, exact_m(scene.poses, s, extrapolated(scene.view.at(o), 0.1)));
    if (least_m <= 0.0) continue;
    check_near_because(clearance_after(arm8(), scene.poses, scene.set->obstacles.data(), scene.set->count, 0.1, 0.05),
                       least_m, 1e-7, "trial %d", trial);
    seen += least_m < 0.05;
  }
  check(seen > 10, "only %d", seen);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(the_arm_has_solids_that_are_no_capsules),
      cmocka_unit_test(the_nearest_pair_is_exact),
      cmocka_unit_test(near_pairs_are_exact_within_4_cm_and_never_farther_than_exact),
      cmocka_unit_test(the_distance_has_no_jumps),
      cmocka_unit_test(the_closest_approach_is_no_farther_than_the_exact_distance_on_the_way),
      cmocka_unit_test(the_clearance_of_a_prediction_is_exact),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
