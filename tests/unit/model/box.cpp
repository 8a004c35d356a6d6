#include "firmware/model/box.h"

#include <algorithm>

#include "firmware/model/nearest_points.h"
#include "firmware/model/proximity.h"
#include "tests/support/check.h"
#include "tests/support/fcl_distance.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::fcl_distance_m;
using test::Random;

namespace {

/// Plates, rods and cubes at random poses.
Box random_box(Random& random, double reach_m) {
  const auto half_m = [&] { return random.chance(0.2) ? 0.001 : random.uniform(0.01, 0.5); };
  const double x = half_m(), y = half_m(), z = half_m();
  return {random.inside(-reach_m, reach_m), random.turn().toRotationMatrix(), Vector3(x, y, z)};
}

/// A link of random pose, or along an edge direction of the box.
Capsule random_link(Random& random, const Box& box, double reach_m) {
  const Vector3 start = random.inside(-reach_m, reach_m);
  const Vector3 displacement = random.chance(0.2) ? Vector3(random.uniform(-0.6, 0.6) * box.axes.col(random.index(3)))
                                                  : Vector3(random.inside(-0.6, 0.6));
  return {start, start + displacement, random.uniform(0.01, 0.1)};
}

Box shifted(const Box& box, const Vector3& by) {
  return {box.centre + by, box.axes, box.half_m};
}

double gap_m(const Capsule& link, const Box& box) {
  return gap_to_box(link.start, link.end, box).distance_m;
}

void distance_of_a_hundred_thousand_pairs_agrees_with_fcl(void**) {
  Random random(1);
  double worst_m = 0.0;
  for (int apart = 0; apart < 100'000;) {
    const Box box = random_box(random, 1.0);
    const Capsule link = random_link(random, box, 1.0);
    const double distance_m = gap_m(link, box) - link.radius_m;
    if (distance_m <= 0.0) continue;
    worst_m = std::max(worst_m, std::abs(distance_m - fcl_distance_m(link, box)));
    check(worst_m < 1e-6, "pair %d: %g m", apart, worst_m);
    ++apart;
  }
  print_message("apart: FCL differs by %.1e m at most\n", worst_m);
}

void penetration_agrees_with_fcl_while_the_axis_is_outside_and_is_never_less_than_by_fcl(void**) {
  Random random(2);
  int shallow = 0, deep = 0;
  while (shallow < 300 || deep < 300) {
    const Box box = random_box(random, 0.4);
    const Capsule link = random_link(random, box, 0.4);
    const double axis_m = gap_m(link, box), distance_m = axis_m - link.radius_m;
    if (distance_m > 0.0) continue;
    const double by_fcl_m = fcl_distance_m(link, box);
    check(by_fcl_m <= 0.0 && distance_m <= by_fcl_m + 1e-6, "%g m, by FCL %g m", distance_m, by_fcl_m);
    if (axis_m > 0.0) check_near(distance_m, by_fcl_m, 1e-6);
    ++(axis_m > 0.0 ? shallow : deep);
  }
}

void depth_is_the_shortest_translation_out_of_the_box(void**) {
  Random random(3);
  for (int overlapping = 0; overlapping < 500;) {
    const Box box = random_box(random, 0.3);
    const Capsule link = random_link(random, box, 0.3);
    const SegmentGap gap = gap_to_box(link.start, link.end, box);
    if (gap.distance_m > -1e-3) continue;
    ++overlapping;
    const Vector3 out = gap.distance_m * gap.normal;  // applied to the box instead of the segment
    check_near(gap_m(link, shifted(box, out)), 0.0, 1e-9);
    check_near(gap_m(link, shifted(box, 1.1 * out)), -0.1 * gap.distance_m, 1e-9);
    for (int direction = 0; direction < 50; ++direction)
      check(gap_m(link, shifted(box, 0.999 * gap.distance_m * random.direction())) <= 0.0, "a shorter translation");
  }
}

void nearest_points_lie_on_both_along_the_normal(void**) {
  Random random(4);
  for (int trial = 0; trial < 5000; ++trial) {
    const Box box = random_box(random, 0.5);
    const Capsule link = random_link(random, box, 0.5);
    const SegmentGap gap = gap_to_box(link.start, link.end, box);
    check_near_because(gap.normal.norm(), 1.0, 1e-9, "trial %d", trial);
    check_near_because(gap.on_solid + gap.distance_m * gap.normal, gap.on_segment, 1e-9, "trial %d", trial);
    check_near_because(nearest_on_segment(link.start, link.end, gap.on_segment), gap.on_segment, 1e-9, "trial %d",
                       trial);
    const Vector3 beyond = (box.axes.transpose() * (gap.on_solid - box.centre)).cwiseAbs() - box.half_m;
    check_near_because(beyond.maxCoeff(), 0.0, 1e-9, "trial %d: off the surface", trial);
  }
}

/// The distance changes by at most the displacement, also where a segment touches or enters the box or where its
/// shortest translation out of it changes direction.
void distance_is_continuous(void**) {
  Random random(5);
  for (int trial = 0; trial < 500; ++trial) {
    const Box box = random_box(random, 0.2);
    const Capsule link = random_link(random, box, 0.4);
    const Vector3 step = 0.005 * random.direction();
    double before_m = gap_m(link, box);
    for (int i = 1; i <= 200; ++i) {
      const double now_m = gap_m(link, shifted(box, i * step));
      check(std::abs(now_m - before_m) <= step.norm() + 1e-8, "trial %d, step %d: %g, then %g m", trial, i, before_m,
            now_m);
      before_m = now_m;
    }
  }
}

void plates_lines_and_points_are_valid_boxes(void**) {
  const Matrix3 straight = Matrix3::Identity();
  const Vector3 above(0, 0, 0.3), aside(1, 0, 0.3);
  check_near(gap_to_box(above, aside, {Vector3::Zero(), straight, {0.5, 0.5, 0}}).distance_m, 0.3, 1e-12);
  check_near(gap_to_box(above, aside, {Vector3::Zero(), straight, {0.5, 0, 0}}).distance_m, 0.3, 1e-12);
  check_near(gap_to_box(above, aside, {Vector3::Zero(), straight, {0, 0, 0}}).distance_m, 0.3, 1e-12);
  check_near(gap_to_box(above, above, {Vector3::Zero(), straight, {1, 1, 0.4}}).distance_m, -0.1, 1e-12);
  check_near(gap_to_box(above, -above, {Vector3::Zero(), straight, {0.5, 0.5, 0}}).distance_m, -0.3, 1e-12);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(distance_of_a_hundred_thousand_pairs_agrees_with_fcl),
      cmocka_unit_test(penetration_agrees_with_fcl_while_the_axis_is_outside_and_is_never_less_than_by_fcl),
      cmocka_unit_test(depth_is_the_shortest_translation_out_of_the_box),
      cmocka_unit_test(nearest_points_lie_on_both_along_the_normal),
      cmocka_unit_test(distance_is_continuous),
      cmocka_unit_test(plates_lines_and_points_are_valid_boxes),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
