#include "host/people/postures.h"

#include <algorithm>

#include "tests/support/check.h"

using namespace sidestep;

namespace {

const Anatomy kAnatomy{1.7, 0.048};

/// Stands, walks 1 m ahead, and reaches.
std::vector<TimedPosture> walk_and_reach() {
  const Posture start = standing(kAnatomy, {0.2, 0.1, -0.5}, 0.3), there = standing(kAnatomy, {1.2, 0.1, -0.5}, 1.3);
  Posture reaching = there;
  reaching.hand_m[1] = {0.4, 0.05, -0.2};
  reaching.lean_rad = 0.2;
  return {{1.0, start}, {3.0, there}, {4.0, reaching}};
}

void check_same(const std::array<Capsule, kBodyParts>& a, const std::array<Capsule, kBodyParts>& b, double within_m) {
  for (size_t part = 0; part < kBodyParts; ++part) {
    check_near_because(a[part].start, b[part].start, within_m, "part %zu", part);
    check_near_because(a[part].end, b[part].end, within_m, "part %zu", part);
  }
}

void minimum_jerk_starts_and_ends_at_rest(void**) {
  check_near(minimum_jerk(0.0), 0.0, 0.0);
  check_near(minimum_jerk(0.5), 0.5, 1e-15);
  check_near(minimum_jerk(1.0), 1.0, 1e-15);
  constexpr double kStep = 1e-4;
  for (const double end : {0.0, 1.0 - kStep}) {
    const double slope = (minimum_jerk(end + kStep) - minimum_jerk(end)) / kStep;
    check_near(slope, 0.0, 1e-6);
  }
}

void a_person_takes_each_posture_at_its_time_and_stays_before_and_after(void**) {
  const auto postures = walk_and_reach();
  for (const TimedPosture& timed : postures)
    check_same(capsules_of(kAnatomy, posture_at(postures, timed.at_s)), capsules_of(kAnatomy, timed.posture), 1e-12);
  check_same(capsules_of(kAnatomy, posture_at(postures, -1.0)), capsules_of(kAnatomy, postures.front().posture), 0.0);
  check_same(capsules_of(kAnatomy, posture_at(postures, 99.0)), capsules_of(kAnatomy, postures.back().posture), 0.0);
}

void a_person_is_at_rest_in_each_posture(void**) {
  const auto postures = walk_and_reach();
  constexpr double kStep_s = 1e-4;
  for (const TimedPosture& timed : postures)
    for (const double at_s : {timed.at_s - kStep_s, timed.at_s + kStep_s})
      check_same(capsules_of(kAnatomy, posture_at(postures, at_s)), capsules_of(kAnatomy, timed.posture),
                 1e-3 * kStep_s);
}

void the_legs_step_while_the_place_changes_and_only_then(void**) {
  const auto postures = walk_and_reach();
  double largest_rad = 0.0;
  for (double t_s = 1.0; t_s < 3.0; t_s += 0.01) {
    const Posture posture = posture_at(postures, t_s);
    largest_rad = std::max(largest_rad, posture.hip_rad[0]);
    check_near(posture.hip_rad[0] + posture.hip_rad[1], 0.0, 1e-12);
  }
  check(largest_rad > 0.25, "%g rad", largest_rad);
  for (double t_s = 3.0; t_s < 4.0; t_s += 0.01) check_near(posture_at(postures, t_s).hip_rad[0], 0.0, 1e-12);
}

void a_record_passes_through_the_postures(void**) {
  const auto postures = walk_and_reach();
  const auto paths = record(
      kAnatomy, [&](double t_s) { return posture_at(postures, t_s); }, 4.0);
  assert_int_equal(paths.size(), kBodyParts);
  for (const double t_s : {0.0, 1.234, 2.0, 3.456, 9.0}) {
    const auto body = capsules_of(kAnatomy, posture_at(postures, t_s));
    for (size_t part = 0; part < kBodyParts; ++part) {
      check_near_because(paths[part].at(t_s).capsule.start, body[part].start, 1e-4, "part %zu at %g s", part, t_s);
      check_near_because(paths[part].at(t_s).capsule.end, body[part].end, 1e-4, "part %zu at %g s", part, t_s);
      check_near(paths[part].at(t_s).capsule.radius_m, body[part].radius_m, 0.0);
    }
  }
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(minimum_jerk_starts_and_ends_at_rest),
      cmocka_unit_test(a_person_takes_each_posture_at_its_time_and_stays_before_and_after),
      cmocka_unit_test(a_person_is_at_rest_in_each_posture),
      cmocka_unit_test(the_legs_step_while_the_place_changes_and_only_then),
      cmocka_unit_test(a_record_passes_through_the_postures),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
