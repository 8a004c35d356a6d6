#include "firmware/control/shield/required_clearance.h"

#include <memory>

#include "tests/support/check.h"

using namespace sidestep;

namespace {

constexpr double kFull_m = 0.02, kRest_m = 0.004;

Obstacle bar() {
  return capsule_obstacle(Vector3(0.5, 0, 0.5), Matrix3::Identity(), 0.05, 0.9);  // its farthest point: 0.5 m
}

void what_rests_may_be_passed_more_closely_than_what_moves(void**) {
  Obstacle obstacle = bar();
  check_near(required_clearance_m(kFull_m, kRest_m, obstacle), kRest_m, 1e-12);
  obstacle.velocity_mps.x() = 0.025;
  check_near(required_clearance_m(kFull_m, kRest_m, obstacle), 0.012, 1e-12);
  obstacle.velocity_mps.x() = 0.05;
  check_near(required_clearance_m(kFull_m, kRest_m, obstacle), kFull_m, 1e-12);
  obstacle.velocity_mps.x() = 3.0;
  check_near(required_clearance_m(kFull_m, kRest_m, obstacle), kFull_m, 1e-12);
  obstacle = bar();
  obstacle.angular_velocity_radps.z() = 0.05;  // 0.025 m/s at its end
  check_near(required_clearance_m(kFull_m, kRest_m, obstacle), 0.012, 1e-12);
}

void a_smaller_full_clearance_is_never_raised(void**) {
  check_near(required_clearance_m(0.003, kRest_m, bar()), 0.003, 0.0);
}

void people_and_other_arms_keep_the_full_clearance_at_rest(void**) {
  Obstacle person = bar(), neighbour = bar();
  person.kind = Kind::kPerson;
  neighbour.id = kNeighbourIds - 3;
  check_near(doubt(person), 1.0, 0.0);
  check_near(doubt(neighbour), 1.0, 0.0);
}

void an_obstacle_that_has_grown_keeps_the_full_clearance_and_surroundings_do_not_grow(void**) {
  const auto set = std::make_unique<ObstacleSet>();
  set->count = 1;
  set->obstacles[0] = bar();
  const std::vector<Obstacle> surroundings{bar()};
  const ShieldSettings settings;
  const ObstacleView exact{set.get(), 0.0, 0.0, &surroundings}, grown{set.get(), 0.0, 0.001, &surroundings};
  check_near(hard_clearance_m(settings, doubt(exact, 0), 0.0), settings.rest_clearance_m, 1e-12);
  check_near(hard_clearance_m(settings, doubt(grown, 0), 0.0), settings.hard_clearance_m, 0.0);
  check_near(hard_clearance_m(settings, doubt(grown, 1), 0.0), settings.rest_clearance_m, 1e-12);
}

void the_faster_the_link_the_more_clearance(void**) {
  const auto set = std::make_unique<ObstacleSet>();
  set->count = 1;
  set->obstacles[0] = bar();
  const ShieldSettings settings;
  const ObstacleView view{set.get()};
  for (const auto& [link_mps, clearance_m] : {std::pair{0.0, 0.004}, {0.25, 0.012}, {0.5, 0.02}, {2.0, 0.02}})
    check_near(hard_clearance_m(settings, doubt(view, 0), link_mps), clearance_m, 1e-12);
  set->obstacles[0].velocity_mps.x() = 0.04;  // more doubtful than the link is fast
  check_near(hard_clearance_m(settings, doubt(view, 0), 0.25), 0.0168, 1e-12);
}

void only_exact_sensing_is_exact(void**) {
  assert_true(is_exact({0.05, 0.0, 0.0}));  // latency alone moves nothing that rests
  assert_false(is_exact({0.0, 0.001, 0.0}));
  assert_false(is_exact({0.0, 0.0, 0.1}));
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(what_rests_may_be_passed_more_closely_than_what_moves),
      cmocka_unit_test(a_smaller_full_clearance_is_never_raised),
      cmocka_unit_test(people_and_other_arms_keep_the_full_clearance_at_rest),
      cmocka_unit_test(an_obstacle_that_has_grown_keeps_the_full_clearance_and_surroundings_do_not_grow),
      cmocka_unit_test(the_faster_the_link_the_more_clearance),
      cmocka_unit_test(only_exact_sensing_is_exact),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
