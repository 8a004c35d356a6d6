#include "firmware/model/capsule.h"

#include <limits>

#include "firmware/model/nearest_points.h"
#include "tests/support/check.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::Random;

namespace {

/// Least distance of two segments by a nested search, without special cases: the distance is convex in both parameters.
double searched_distance(const Capsule& a, const Capsule& b) {
  const auto along_b = [&](double s) {
    const Vector3 p = a.start + s * (a.end - a.start);
    double low = 0.0, high = 1.0;
    for (int i = 0; i < 60; ++i) {
      const double left = low + (high - low) / 3, right = high - (high - low) / 3;
      const bool go_left =
          (b.start + left * (b.end - b.start) - p).norm() < (b.start + right * (b.end - b.start) - p).norm();
      (go_left ? high : low) = go_left ? right : left;
    }
    return (b.start + low * (b.end - b.start) - p).norm();
  };
  double low = 0.0, high = 1.0;
  for (int i = 0; i < 60; ++i) {
    const double left = low + (high - low) / 3, right = high - (high - low) / 3;
    const bool go_left = along_b(left) < along_b(right);
    (go_left ? high : low) = go_left ? right : left;
  }
  return along_b(low);
}

double off_segment(const Capsule& capsule, const Vector3& p) {
  const Vector3 axis = capsule.end - capsule.start;
  const double length = axis.norm();
  if (length == 0.0) return (p - capsule.start).norm();
  const double along = axis.dot(p - capsule.start) / length;
  const double beyond = std::max({0.0, -along, along - length});
  return std::max(beyond, (p - capsule.start - along / length * axis).norm());
}

/// Random pairs, two thirds of them special cases: points, parallel and nearly parallel axes, axes that meet.
std::pair<Capsule, Capsule> random_pair(Random& random) {
  Capsule a{random.inside(-1, 1), random.inside(-1, 1), 0.1}, b{random.inside(-1, 1), random.inside(-1, 1), 0.1};
  const double tilt = std::pow(10.0, random.uniform(-12, -2));
  switch (random.index(12)) {
    case 0:
      a.end = a.start;
      break;
    case 1:
      b.end = b.start;
      break;
    case 2:
      a.end = a.start, b.end = b.start;
      break;
    case 3:
      b.end = b.start + random.uniform(-2, 2) * (a.end - a.start);
      break;
    case 4:
      b.end = b.start + random.uniform(-2, 2) * (a.end - a.start) + tilt * random.direction();
      break;
    case 5:
      b.start = a.start + random.uniform(0, 1) * (a.end - a.start);
      break;
    case 6:
      b = a;
      break;
    case 7:
      b.start = a.end;
      break;
    default:
      break;
  }
  return {a, b};
}

/// The crossing of nearly parallel axes is ill-conditioned, hence the wider tolerance.
double tolerance_m(const Capsule& a, const Capsule& b) {
  const Vector3 u = (a.end - a.start).normalized(), v = (b.end - b.start).normalized();
  const double sine = u.cross(v).norm();
  return sine > 0.0 && sine < 1e-3 ? 3e-6 : 1e-9;
}

void nearest_point_of_a_segment_beats_every_sampled_point(void**) {
  Random random(1);
  for (int trial = 0; trial < 2000; ++trial) {
    const Vector3 start = random.inside(-1, 1), end = trial % 10 ? random.inside(-1, 1) : start,
                  p = random.inside(-2, 2);
    const Vector3 nearest = nearest_on_segment(start, end, p);
    check(off_segment({start, end, 0}, nearest) < 1e-12, "trial %d: not on the segment", trial);
    for (int i = 0; i <= 20; ++i)
      check((nearest - p).norm() <= (start + i / 20.0 * (end - start) - p).norm() + 1e-12, "trial %d, sample %d", trial,
            i);
  }
}

void nearest_points_of_two_axes_agree_with_a_search(void**) {
  Random random(2);
  for (int trial = 0; trial < 1500; ++trial) {
    const auto [a, b] = random_pair(random);
    const NearestPoints points = nearest_on_axes(a, b);
    check(off_segment(a, points.a) < 1e-9 && off_segment(b, points.b) < 1e-9, "trial %d: off the axes", trial);
    check_near_because((points.a - points.b).norm(), searched_distance(a, b), tolerance_m(a, b), "trial %d", trial);
  }
}

void nearest_points_do_not_depend_on_the_order_of_the_ends(void**) {
  Random random(3);
  for (int trial = 0; trial < 2000; ++trial) {
    const auto [a, b] = random_pair(random);
    const double distance = (nearest_on_axes(a, b).a - nearest_on_axes(a, b).b).norm();
    const NearestPoints swapped = nearest_on_axes(b, a), rotated = nearest_on_axes({a.end, a.start, a.radius_m}, b);
    check_near_because((swapped.a - swapped.b).norm(), distance, tolerance_m(a, b), "trial %d: a and b swapped", trial);
    check_near_because((rotated.a - rotated.b).norm(), distance, tolerance_m(a, b), "trial %d: a turned around", trial);
  }
}

void nearest_points_of_segments_worked_out_by_hand(void**) {
  const Capsule x{Vector3(0, 0, 0), Vector3(2, 0, 0), 0.1};
  // Crossing 1 m above each other.
  const NearestPoints crossing = nearest_on_axes(x, {Vector3(0.5, -1, 1), Vector3(0.5, 1, 1), 0.1});
  check_near(crossing.a, Vector3(0.5, 0, 0), 1e-15);
  check_near(crossing.b, Vector3(0.5, 0, 1), 1e-15);
  // Beyond the end, both clamped.
  const NearestPoints beyond = nearest_on_axes(x, {Vector3(3, 4, 0), Vector3(3, 9, 0), 0.1});
  check_near(beyond.a, Vector3(2, 0, 0), 1e-15);
  check_near(beyond.b, Vector3(3, 4, 0), 1e-15);
  // In one line, with a gap.
  const NearestPoints in_line = nearest_on_axes(x, {Vector3(7, 0, 0), Vector3(5, 0, 0), 0.1});
  check_near(in_line.a, Vector3(2, 0, 0), 1e-15);
  check_near(in_line.b, Vector3(5, 0, 0), 1e-15);
  // Meeting.
  const NearestPoints meeting = nearest_on_axes(x, {Vector3(1, -1, 0), Vector3(1, 3, 0), 0.1});
  check_near(meeting.a, Vector3(1, 0, 0), 1e-15);
  check_near(meeting.b, Vector3(1, 0, 0), 1e-15);
}

void the_capsule_around_a_box_contains_all_corners_and_touches_them(void**) {
  Random random(4);
  for (int trial = 0; trial < 1000; ++trial) {
    Vector3 edges(random.uniform(0.01, 2), random.uniform(0.01, 2), random.uniform(0.01, 2));
    if (trial % 7 == 0) edges[1] = edges[0];
    if (trial % 11 == 0) edges.setConstant(edges[0]);
    if (trial % 13 == 0) edges[random.index(3)] = 0.0;
    const Capsule capsule = capsule_around_box(edges);
    double farthest = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
      const Vector3 sign(corner & 1 ? 0.5 : -0.5, corner & 2 ? 0.5 : -0.5, corner & 4 ? 0.5 : -0.5);
      const Vector3 p = edges.cwiseProduct(sign);
      farthest = std::max(farthest, (p - nearest_on_segment(capsule.start, capsule.end, p)).norm());
    }
    check_near_because(farthest, capsule.radius_m, 1e-12, "trial %d", trial);
    check_near_because((capsule.end - capsule.start).norm(), edges.maxCoeff(), 1e-12, "trial %d", trial);
  }
}

void a_capsule_contains_another_when_all_sampled_surface_points_are_inside(void**) {
  Random random(5);
  int contained = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const Capsule outer{random.inside(-0.2, 0.2), random.inside(-0.2, 0.2), random.uniform(0.1, 0.5)};
    const Capsule inner{random.inside(-0.3, 0.3), random.inside(-0.3, 0.3), random.uniform(0.0, 0.2)};
    // The inner capsule's farthest surface points lie around its ends.
    double farthest = 0.0;
    for (const Vector3& end : {inner.start, inner.end}) {
      const Vector3 out = end - nearest_on_segment(outer.start, outer.end, end);
      const Vector3 p = end + inner.radius_m * (out.norm() > 0 ? out.normalized() : Vector3(Vector3::UnitX()));
      farthest = std::max(farthest, (p - nearest_on_segment(outer.start, outer.end, p)).norm());
    }
    if (std::abs(farthest - outer.radius_m) < 1e-6) continue;
    check(contains(outer, inner) == (farthest < outer.radius_m), "trial %d", trial);
    contained += contains(outer, inner);
  }
  check(contained > 50 && contained < 1950, "%d of 2000 contained: too one-sided", contained);
}

void a_sphere_at_the_end_of_a_cylinder_is_contained(void**) {
  const Capsule capsule{Vector3(0, 0, 0), Vector3(0, 0, 0.3), 0.05};
  assert_true(contains(capsule, {capsule.end, capsule.end, 0.05}));
  assert_true(contains(capsule, capsule));
  assert_false(contains(capsule, {capsule.end, capsule.end, 0.0501}));
  assert_false(contains({capsule.end, capsule.end, 0.05}, capsule));
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(nearest_point_of_a_segment_beats_every_sampled_point),
      cmocka_unit_test(nearest_points_of_two_axes_agree_with_a_search),
      cmocka_unit_test(nearest_points_do_not_depend_on_the_order_of_the_ends),
      cmocka_unit_test(nearest_points_of_segments_worked_out_by_hand),
      cmocka_unit_test(the_capsule_around_a_box_contains_all_corners_and_touches_them),
      cmocka_unit_test(a_capsule_contains_another_when_all_sampled_surface_points_are_inside),
      cmocka_unit_test(a_sphere_at_the_end_of_a_cylinder_is_contained),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
