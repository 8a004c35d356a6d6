#include "host/sim/solid.h"

#include <string>

#include "tests/support/check.h"
#include "tests/support/random.h"
#include "tests/support/scratch.h"

using namespace sidestep::sim;
using Eigen::Isometry3d;
using Eigen::Vector3d;
using sidestep::test::Random;

namespace {

const Solid kCylinder{Shape::kCylinder, {0.05, 0.3, 0}}, kBall{Shape::kSphere, {0.05, 0, 0}},
    kCube{Shape::kBox, {0.2, 0.2, 0.2}}, kCapsule{Shape::kCapsule, {0.05, 0.2, 0}};

Isometry3d at(const Vector3d& position_m, const Vector3d& axis = Vector3d::UnitZ(), double turn_rad = 0) {
  return Eigen::Translation3d(position_m) * Eigen::AngleAxisd(turn_rad, axis);
}

Isometry3d lying(const Vector3d& position_m) {
  return at(position_m, Vector3d::UnitY(), M_PI / 2);
}  // z along x

struct Case {
  const char* name;
  Solid a, b;
  Isometry3d base_from_b;  // a is at the origin
  double distance_m;
  double tolerance_m;
};

const Case kCases[] = {
    {"ball beside cylinder", kCylinder, kBall, at({0.2, 0, 0.1}), 0.1, 1e-12},
    {"ball above cylinder", kCylinder, kBall, at({0.02, 0, 0.3}), 0.1, 1e-12},
    {"ball off the rim of cylinder", kCylinder, kBall, at({0.05 + 0.09, 0, 0.15 + 0.12}), 0.1, 1e-12},
    {"ball in the side of cylinder", kCylinder, kBall, at({0.07, 0, 0}), -0.03, 1e-12},
    {"ball in the end of cylinder", kCylinder, kBall, at({0, 0, 0.18}), -0.02, 1e-12},
    {"ball on the axis of cylinder", kCylinder, kBall, at({0, 0, 0}), -0.1, 1e-12},
    {"ball touches cylinder", kCylinder, kBall, at({0, 0.1, 0}), 0, 1e-12},
    {"ball beside ball", kBall, kBall, at({0, 0.3, 0.4}), 0.4, 1e-12},
    {"ball in ball", kBall, kBall, at({0.06, 0, 0.08}), 0.0, 1e-12},
    {"ball on ball", kBall, kBall, at({0, 0, 0}), -0.1, 1e-12},
    {"ball off a corner of cube", kCube, kBall, at({0.12, 0.14, 0.14}), -0.05 + 0.06, 1e-12},
    {"ball in a face of cube", kCube, kBall, at({0, 0, -0.09}), -0.06, 1e-12},
    {"ball beside capsule", kBall, kCapsule, at({0.2, 0, 0.09}), 0.1, 1e-9},
    {"ball beyond the end of capsule", kBall, kCapsule, at({0, 0, 0.3}), 0.1, 1e-9},
    {"ball in capsule", kBall, kCapsule, at({0.03, 0, 0.05}), -0.07, 1e-9},
    {"capsule beside cylinder", kCylinder, kCapsule, at({0.15, 0.2, 0}), 0.15, 1e-9},
    {"capsule across cylinder", kCylinder, kCapsule, lying({0, 0.2, 0.1}), 0.1, 1e-9},
    {"capsule points at cylinder", kCylinder, kCapsule, lying({0.3, 0, 0}), 0.1, 1e-9},
    {"capsule points into cylinder", kCylinder, kCapsule, lying({0.17, 0, 0.02}), -0.03, 1e-9},
    {"capsule across in cylinder", kCylinder, kCapsule, lying({0, 0.08, 0}), -0.02, 1e-9},
    {"capsule along in cylinder", kCylinder, kCapsule, at({0, 0.06, 0.1}), -0.04, 1e-9},
    {"capsule on the axis of cylinder", kCylinder, kCapsule, at({0, 0, 0}), -0.1, 1e-9},
    {"capsule over cube", kCube, kCapsule, lying({0.05, 0.05, 0.2}), 0.05, 1e-9},
    {"capsule in cube", kCube, kCapsule, lying({0.05, 0.05, 0.12}), -0.03, 1e-9},
    {"cube beside cylinder", kCylinder, kCube, at({0.3, 0, 0}), 0.15, 1e-9},
    {"edge of cube beside cylinder", kCylinder, kCube, at({0.3, 0, 0}, Vector3d::UnitZ(), M_PI / 4),
     0.25 - 0.1 * M_SQRT2, 1e-9},
    {"cube over cylinder", kCylinder, kCube, at({0.1, 0.05, 0.3}), 0.05, 1e-9},
    {"cube in the side of cylinder", kCylinder, kCube, at({0.13, 0, 0}), -0.02, 1e-6},
    {"cube touches cylinder", kCylinder, kCube, at({0.15, 0, 0}), 0, 1e-8},
    {"cylinder across cylinder", kCylinder, kCylinder, lying({0, 0.03, 0}), -0.07, 1e-9},
    {"cylinder along cylinder", kCylinder, kCylinder, at({0, 0.03, 0.1}), -0.07, 1e-9},
    {"capsule touches cylinder", kCylinder, kCapsule, lying({0, 0.1, 0.1}), 0, 1e-9},
    {"cube touches cube", kCube, kCube, at({0.05, 0.2, 0}), 0, 1e-9},
    {"cube beside cube", kCube, kCube, at({0.05, 0.3, 0.1}), 0.1, 1e-9},
    {"cube in cube", kCube, kCube, at({0.01, 0.17, 0.02}), -0.03, 1e-9},
};

void distances_agree_with_hand_computed_ones(void**) {
  for (const Case& c : kCases) {
    check_near_because(signed_distance_m(c.a, at({0, 0, 0}), c.b, c.base_from_b), c.distance_m, c.tolerance_m, "%s",
                       c.name);
    check_near_because(signed_distance_m(c.b, c.base_from_b, c.a, at({0, 0, 0})), c.distance_m, c.tolerance_m,
                       "%s, swapped", c.name);
  }
}

Solid random_solid(Random& random) {
  const Shape shapes[] = {Shape::kSphere, Shape::kCapsule, Shape::kBox, Shape::kCylinder};
  return {shapes[random.index(4)], random.inside(0.01, 0.4)};
}

// A third of the poses are on a grid with aligned axes, where degenerate cases occur.
Isometry3d random_pose(Random& random) {
  Vector3d position_m = random.inside(-0.4, 0.4);
  if (!random.chance(1.0 / 3)) return Eigen::Translation3d(position_m) * random.turn();
  position_m = (position_m * 10).array().round() / 10;
  return at(position_m, Vector3d::Unit(random.index(3)), random.index(4) * M_PI / 2);
}

void distances_are_finite_and_within_their_bounds(void**) {
  Random random(1);
  for (int trial = 0; trial < 5000; ++trial) {
    const Solid a = random_solid(random), b = random_solid(random);
    const Isometry3d base_from_a = random_pose(random), base_from_b = random_pose(random);
    const double centres_m = (base_from_a.translation() - base_from_b.translation()).norm();
    const double distance_m = signed_distance_m(a, base_from_a, b, base_from_b);
    check(distance_m <= centres_m, "trial %d: %g", trial, distance_m);
    check(distance_m >= centres_m - bounding_radius_m(a) - bounding_radius_m(b) - 1e-9, "trial %d: %g", trial,
          distance_m);
  }
}

// A shift changes a distance by at most the length of the shift, also where surfaces begin to touch.
void distances_are_continuous_from_separated_to_penetrating(void**) {
  Random random(2);
  const Solid links[] = {kCylinder, kBall}, obstacles[] = {kBall, kCapsule};
  for (int trial = 0; trial < 400; ++trial) {
    const Solid &a = links[trial % 2], &b = obstacles[trial / 2 % 2];
    Isometry3d base_from_b = random_pose(random);
    const Vector3d step_m = -base_from_b.translation().normalized() * 0.002;
    double before_m = signed_distance_m(a, at({0, 0, 0}), b, base_from_b);
    for (int i = 0; i < 100; ++i) {
      base_from_b.pretranslate(step_m);
      const double distance_m = signed_distance_m(a, at({0, 0, 0}), b, base_from_b);
      check(std::abs(distance_m - before_m) <= 0.002 + 1e-7, "trial %d: from %g to %g", trial, before_m, distance_m);
      before_m = distance_m;
    }
  }
}

/// A box of these edges around the origin, as a mesh.
Solid box_mesh(const Vector3d& edges_m) {
  std::string text;
  for (int i = 0; i < 8; ++i) {
    text += "v";
    for (int k = 0; k < 3; ++k) text += ' ' + std::to_string((i >> k & 1 ? 0.5 : -0.5) * edges_m[k]);
    text += '\n';
  }
  for (const char* face :
       {"1 2 4", "1 4 3", "5 7 8", "5 8 6", "1 5 6", "1 6 2", "3 4 8", "3 8 7", "1 3 7", "1 7 5", "2 6 8", "2 8 4"})
    text += std::string("f ") + face + '\n';
  return load_mesh_solid(sidestep::test::scratch_file("box.obj", text), "any.urdf", {}, {1, 1, 1}).solid;
}

void meshes_of_bars_have_the_distances_of_the_bars(void**) {
  Random random(3);
  const Vector3d edges_m(0.1, 0.12, 0.4);
  const Solid bar{Shape::kBox, edges_m}, mesh = box_mesh(edges_m);
  int touching = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const Isometry3d base_from_a = random_pose(random), base_from_b = random_pose(random);
    const double expected_m = signed_distance_m(bar, base_from_a, bar, base_from_b);
    const double distance_m = signed_distance_m(mesh, base_from_a, mesh, base_from_b);
    if (expected_m > 0.0) check_near_because(distance_m, expected_m, 5e-3, "trial %d", trial);
    if (expected_m < -5e-3) check(distance_m <= 0.0, "trial %d: %g, of bars %g", trial, distance_m, expected_m);
    touching += distance_m <= 0.0;
  }
  check(touching > 100, "only %d touch", touching);
}

void distances_below_the_range_do_not_depend_on_it(void**) {
  Random random(4);
  const Solid mesh = box_mesh({0.05, 0.06, 0.4});
  int near = 0, far = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const Solid a = random.chance(0.3) ? mesh : random_solid(random),
                b = random.chance(0.3) ? mesh : random_solid(random);
    const Isometry3d base_from_a = random_pose(random), base_from_b = random_pose(random);
    const double full_m = signed_distance_m(a, base_from_a, b, base_from_b), range_m = random.uniform(0.0, 0.2);
    const double distance_m = signed_distance_m(a, base_from_a, b, base_from_b, range_m);
    if (full_m < range_m) {
      check_near_because(distance_m, full_m, 1e-6, "trial %d", trial);
      ++near;
    } else {
      check(distance_m >= range_m - 1e-9 && distance_m > 0.0, "trial %d: %g, range %g", trial, distance_m, range_m);
      ++far;
    }
  }
  check(near > 500 && far > 500, "%d near, %d far", near, far);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(distances_agree_with_hand_computed_ones),
      cmocka_unit_test(distances_are_finite_and_within_their_bounds),
      cmocka_unit_test(distances_are_continuous_from_separated_to_penetrating),
      cmocka_unit_test(meshes_of_bars_have_the_distances_of_the_bars),
      cmocka_unit_test(distances_below_the_range_do_not_depend_on_it),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
