// Every distance is checked by a certificate: the two points lie on the cores, so that the distance is no larger than
// that between them, and the cores are as far apart along the normal, so that it is no smaller. Both are computed here
// without the search: extents over all vertices, and membership by face planes.
#include "firmware/model/gjk.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "firmware/model/load/convex_hull.h"
#include "firmware/model/nearest_points.h"
#include "tests/support/allocation_count.h"
#include "tests/support/check.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::Random;

namespace {

constexpr double kExact_m = 1e-9;

struct Part {
  ConvexHull hull;
  Polyhedron polyhedron;
};

/// A convex polyhedron of 4 to 96 vertices; one in four is a thin plate.
Part random_part(Random& random) {
  Vector3 size_m = random.inside(0.01, 0.3);
  if (random.chance(0.25)) size_m[random.index(3)] = 1e-4;
  std::vector<Vector3> points;
  const int count = 4 + random.index(93);
  for (int i = 0; i < count; ++i) points.push_back(random.direction().cwiseProduct(size_m));
  Part part{convex_hull(points), {}};
  part.polyhedron = polyhedron_of(part.hull);
  return part;
}

const std::vector<Part>& parts() {
  static const std::vector<Part> all = [] {
    Random random(1);
    std::vector<Part> made;
    for (int i = 0; i < 200; ++i) made.push_back(random_part(random));
    return made;
  }();
  return all;
}

/// Any core and radius, anywhere within reach_m. `part` receives the polyhedron's index, or -1.
ConvexSolid random_solid(Random& random, double reach_m, int& part) {
  ConvexSolid solid;
  part = -1;
  solid.kind = static_cast<CoreKind>(random.index(5));
  solid.half_m = random.inside(0.005, 0.3);
  if (random.chance(0.1)) solid.half_m[random.index(3)] = 1e-5;
  if (solid.kind == CoreKind::kCylinder) solid.half_m.y() = solid.half_m.x();
  if (solid.kind == CoreKind::kPolyhedron) {
    part = random.index(static_cast<int>(parts().size()));
    solid.polyhedron = &parts()[static_cast<size_t>(part)].polyhedron;
  }
  solid.radius_m = random.chance(0.5) ? 0.0 : random.uniform(0.0, 0.1);
  solid.rotation = random.turn().toRotationMatrix();
  solid.centre = random.inside(-reach_m, reach_m);
  return solid;
}

/// The largest n . p over the core.
double extent_m(const ConvexSolid& solid, const Vector3& n) {
  const Vector3 d = solid.rotation.transpose() * n;
  const double centre_m = n.dot(solid.centre);
  switch (solid.kind) {
    case CoreKind::kPoint:
      return centre_m;
    case CoreKind::kSegment:
      return centre_m + std::abs(d.dot(solid.half_m));
    case CoreKind::kBox:
      return centre_m + d.cwiseAbs().dot(solid.half_m);
    case CoreKind::kCylinder:
      return centre_m + std::hypot(d.x(), d.y()) * solid.half_m.x() + std::abs(d.z()) * solid.half_m.z();
    case CoreKind::kPolyhedron:
      break;
  }
  double largest_m = -1e9;
  for (const Vector3& vertex : solid.polyhedron->vertices) largest_m = std::max(largest_m, d.dot(vertex));
  return centre_m + largest_m;
}

double separation_m(const ConvexSolid& a, const ConvexSolid& b, const Vector3& normal) {
  return -extent_m(a, -normal) - extent_m(b, normal);
}

/// How far a point lies outside of the core, m; 0 inside.
double outside_m(const ConvexSolid& solid, int part, const Vector3& point) {
  const Vector3 p = solid.rotation.transpose() * (point - solid.centre);
  switch (solid.kind) {
    case CoreKind::kPoint:
      return p.norm();
    case CoreKind::kSegment:
      return (p - nearest_on_segment(-solid.half_m, solid.half_m, p)).norm();
    case CoreKind::kBox:
      return (p.cwiseAbs() - solid.half_m).maxCoeff();
    case CoreKind::kCylinder:
      return std::max(std::hypot(p.x(), p.y()) - solid.half_m.x(), std::abs(p.z()) - solid.half_m.z());
    case CoreKind::kPolyhedron:
      break;
  }
  return parts()[static_cast<size_t>(part)].hull.outside_m(p);
}

struct Pair {
  ConvexSolid a, b;
  int part_a, part_b;
};

Pair random_pair(Random& random, double reach_m) {
  Pair pair;
  pair.a = random_solid(random, reach_m, pair.part_a);
  pair.b = random_solid(random, reach_m, pair.part_b);
  return pair;
}

void check_certificate(const Pair& pair, const SolidGap& gap, int trial) {
  const auto& [a, b, part_a, part_b] = pair;
  check_near_because(gap.normal.norm(), 1.0, 1e-12, "trial %d", trial);
  check_near_because(gap.distance_m, gap.core_m - a.radius_m - b.radius_m, 1e-12, "trial %d", trial);
  check_near_because(gap.on_a, gap.on_b + gap.core_m * gap.normal, kExact_m, "trial %d", trial);
  check_near_because(separation_m(a, b, gap.normal), gap.core_m, kExact_m, "trial %d: kinds %d and %d", trial,
                     static_cast<int>(a.kind), static_cast<int>(b.kind));
  check(outside_m(a, part_a, gap.on_a) < kExact_m, "trial %d: not on a, kind %d", trial, static_cast<int>(a.kind));
  if (gap.core_m > 0.0)
    check(outside_m(b, part_b, gap.on_b) < kExact_m, "trial %d: not on b, kind %d", trial, static_cast<int>(b.kind));
}

/// SIDESTEP_GJK_PAIRS sets another number of pairs.
int trials() {
  const char* const given = std::getenv("SIDESTEP_GJK_PAIRS");
  return given ? std::atoi(given) : 30000;
}

void the_distance_of_any_two_solids_is_certified_by_its_points_and_its_normal(void**) {
  Random random(2);
  int apart = 0, overlapping = 0;
  for (int trial = 0; trial < trials(); ++trial) {
    const Pair pair = random_pair(random, random.chance(0.5) ? 0.5 : 0.2);
    const SolidGap gap = gap_between(pair.a, pair.b, random.direction());
    check_certificate(pair, gap, trial);
    ++(gap.core_m > 0.0 ? apart : overlapping);
  }
  check(apart > trials() / 4 && overlapping > trials() / 20, "%d apart, %d overlapping", apart, overlapping);
}

/// A pair is moved until its cores are so far apart along a normal that both have a vertex or face on it.
void a_known_gap_is_found_also_where_the_cores_touch(void**) {
  Random random(3);
  const double gaps_m[] = {0.0, 1e-12, 1e-9, 1e-7, 1e-5, 1e-3, 0.1};
  for (int trial = 0; trial < trials(); ++trial) {
    Pair pair = random_pair(random, 0.3);
    const SolidGap before = gap_between(pair.a, pair.b, random.direction());
    const double known_m = gaps_m[random.index(7)];
    if (before.core_m <= 0.0) continue;
    pair.a.centre -= (before.core_m - known_m) * before.normal;  // the nearest points stay the nearest
    const SolidGap gap = gap_between(pair.a, pair.b, random.direction());
    check_near_because(gap.core_m, known_m, known_m > 1e-9 ? 1e-7 : 1e-6, "trial %d: kinds %d and %d", trial,
                       static_cast<int>(pair.a.kind), static_cast<int>(pair.b.kind));
    check(gap.normal.allFinite() && gap.on_a.allFinite() && gap.on_b.allFinite(), "trial %d", trial);
  }
}

/// With the normal of the time before as the guess. Cores without volume pass through each other.
void the_depth_of_a_slight_overlap_is_small(void**) {
  Random random(4);
  for (int trial = 0; trial < trials() / 3; ++trial) {
    Pair pair = random_pair(random, 0.3);
    const SolidGap before = gap_between(pair.a, pair.b, random.direction());
    if (before.core_m <= 1e-6) continue;
    const double depth_m = 1e-4;
    pair.a.centre -= (before.core_m + depth_m) * before.normal;
    const SolidGap gap = gap_between(pair.a, pair.b, before.normal);
    check(std::abs(gap.core_m) <= depth_m + kExact_m, "trial %d: %g m", trial, gap.core_m);
  }
}

void two_segments_agree_with_the_nearest_points_of_capsules(void**) {
  Random random(5);
  for (int trial = 0; trial < 20000; ++trial) {
    const Capsule a{random.inside(-0.5, 0.5), random.inside(-0.5, 0.5), random.uniform(0.0, 0.1)};
    const Capsule b{random.inside(-0.5, 0.5), random.inside(-0.5, 0.5), random.uniform(0.0, 0.1)};
    const NearestPoints points = nearest_on_axes(a, b);
    const SolidGap gap = gap_between(ConvexSolid::of(a), ConvexSolid::of(b), random.direction());
    check_near_because(gap.core_m, (points.a - points.b).norm(), kExact_m, "trial %d", trial);
  }
}

void a_segment_and_a_box_agree_with_gap_to_box(void**) {
  Random random(6);
  for (int trial = 0; trial < 20000; ++trial) {
    const Capsule link{random.inside(-0.5, 0.5), random.inside(-0.5, 0.5), 0.0};
    const Box box{random.inside(-0.3, 0.3), random.turn().toRotationMatrix(), random.inside(0.0, 0.3)};
    const SegmentGap expected = gap_to_box(link.start, link.end, box);
    const SolidGap gap = gap_between(ConvexSolid::of(link), ConvexSolid::of(box, 0.0), random.direction());
    if (expected.distance_m > 1e-8) check_near_because(gap.core_m, expected.distance_m, kExact_m, "trial %d", trial);
    if (expected.distance_m < -1e-8) check(gap.core_m <= expected.distance_m + kExact_m, "trial %d", trial);
  }
}

void a_search_that_ends_early_returns_a_lower_bound(void**) {
  Random random(7);
  int early = 0;
  for (int trial = 0; trial < trials() / 3; ++trial) {
    const Pair pair = random_pair(random, 0.6);
    const Vector3 guess = random.direction();
    const SolidGap exact = gap_between(pair.a, pair.b, guess);
    const double exact_m = exact.distance_m, enough_m = random.uniform(-0.1, 0.3);
    const double bound_m = gap_between(pair.a, pair.b, guess, enough_m).distance_m;
    if (exact_m < enough_m) {
      check_near_because(bound_m, exact_m, kExact_m, "trial %d", trial);
      continue;
    }
    const double alone_m = distance_between_m(pair.a, pair.b, guess, enough_m);
    if (exact.core_m > 0.0) check_near_because(alone_m, bound_m, 0.0, "trial %d", trial);
    if (exact.core_m <= 0.0)
      check(alone_m <= exact_m + kExact_m, "trial %d: %g m in place of %g m", trial, alone_m, exact_m);
    check(bound_m >= enough_m - kExact_m && bound_m <= exact_m + kExact_m, "trial %d: %g, exact %g, enough %g", trial,
          bound_m, exact_m, enough_m);
    if (bound_m < exact_m - 1e-6) ++early;
  }
  check(early > 100, "only %d searches ended early", early);
}

/// Across a path without overlap of the cores the normal turns no faster than the gap permits.
void the_normal_is_continuous_outside_of_the_cores(void**) {
  Random random(8);
  for (int trial = 0; trial < 2000; ++trial) {
    Pair pair = random_pair(random, 0.4);
    const double step_m = 1e-6;
    const SolidGap before = gap_between(pair.a, pair.b, random.direction());
    if (before.core_m < 0.01) continue;
    pair.a.centre += step_m * random.direction();
    const SolidGap after = gap_between(pair.a, pair.b, random.direction());
    check((after.normal - before.normal).norm() < 2.0 * step_m / before.core_m + 3e-4, "trial %d: %g", trial,
          (after.normal - before.normal).norm());
  }
}

void solids_at_one_place_have_a_finite_gap(void**) {
  Random random(9);
  for (int trial = 0; trial < 3000; ++trial) {
    Pair pair = random_pair(random, 0.3);
    pair.b.centre = pair.a.centre;
    if (random.chance(0.5)) pair.b.rotation = pair.a.rotation;
    const SolidGap gap =
        gap_between(pair.a, pair.b, random.chance(0.1) ? Vector3(Vector3::Zero()) : random.direction());
    check(std::isfinite(gap.distance_m) && gap.normal.allFinite() && gap.on_a.allFinite() && gap.on_b.allFinite(),
          "trial %d: kinds %d and %d", trial, static_cast<int>(pair.a.kind), static_cast<int>(pair.b.kind));
    check_near_because(gap.normal.norm(), 1.0, 1e-12, "trial %d", trial);
  }
}

void no_search_allocates(void**) {
  Random random(10);
  parts();
  for (int trial = 0; trial < 1000; ++trial) {
    const Pair pair = random_pair(random, 0.4);
    const Vector3 guess = random.direction();
    const int64_t before = test::allocation_count();
    gap_between(pair.a, pair.b, guess);
    assert_int_equal(test::allocation_count(), before);
  }
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(the_distance_of_any_two_solids_is_certified_by_its_points_and_its_normal),
      cmocka_unit_test(a_known_gap_is_found_also_where_the_cores_touch),
      cmocka_unit_test(the_depth_of_a_slight_overlap_is_small),
      cmocka_unit_test(two_segments_agree_with_the_nearest_points_of_capsules),
      cmocka_unit_test(a_segment_and_a_box_agree_with_gap_to_box),
      cmocka_unit_test(a_search_that_ends_early_returns_a_lower_bound),
      cmocka_unit_test(the_normal_is_continuous_outside_of_the_cores),
      cmocka_unit_test(solids_at_one_place_have_a_finite_gap),
      cmocka_unit_test(no_search_allocates),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
