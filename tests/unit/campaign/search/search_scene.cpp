#include "host/campaign/search/search_scene.h"

#include "firmware/io/config/config.h"
#include "firmware/model/nearest_points.h"
#include "host/campaign/search/search_scene_maker.h"
#include "tests/support/capsule_truth.h"
#include "tests/support/check.h"

using namespace sidestep::campaign;
using sidestep::Capsule;
using sidestep::Vector3;

namespace {

const Limits& limits() {
  static const Limits all = sidestep::load_config("firmware/config/lwa3.yaml", {}).model.arm.limits;
  return all;
}

/// Drawn scenes of both families with 1 to 5 obstacles, each followed by mutations of it.
const std::vector<SearchScene>& scenes() {
  static const std::vector<SearchScene> all = [] {
    std::vector<SearchScene> made;
    for (int obstacles = 1; obstacles <= 5; ++obstacles) {
      const SearchSpace space{obstacles % 2 == 0 ? SearchFamily::kRest : SearchFamily::kTrack, obstacles, 0.5,
                              limits()};
      Random random("test", static_cast<uint64_t>(obstacles));
      for (int k = 0; k < 4; ++k) {
        made.push_back(draw_search_scene(random, space));
        for (int m = 0; m < 10; ++m) made.push_back(mutated(random, space, made.back()));
      }
    }
    return made;
  }();
  return all;
}

void distances_agree_with_fcl_and_the_urdf(void**) {
  sidestep::test::CapsuleTruth truth;
  int contacts = 0;
  for (const SearchScene& scene : scenes()) {
    const ArmPose pose = lwa3_arm().pose(scene.start_rad);
    for (double t_s = 0.0; t_s < scene.duration_s(); t_s += 0.1) {
      const double expected_m = truth.clearance_m(scene, scene.start_rad, t_s);
      const double actual_m = clearance_m(scene, pose, t_s);
      if (expected_m < 0.0) ++contacts;
      // Of a deep penetration the truth is only a bound.
      if (expected_m > -0.03) check_near(actual_m, expected_m, 1e-6);
      check((actual_m < 0.0) == (expected_m < 0.0), "%g m and %g m", actual_m, expected_m);
    }
  }
  check(contacts > 100, "only %d instants with contact", contacts);
}

void no_obstacle_is_nearer_than_half_a_metre_at_first(void**) {
  sidestep::test::CapsuleTruth truth;
  for (const SearchScene& scene : scenes()) {
    const double first_m = truth.clearance_m(scene, scene.start_rad, 0.0);
    check(first_m >= 0.5 - 1e-6, "%g m", first_m);
  }
}

void obstacles_keep_their_speed_and_miss_the_base_column(void**) {
  for (const SearchScene& scene : scenes()) {
    check(scene.duration_s() <= 8.0, "%g s", scene.duration_s());
    for (const MovingCapsule& obstacle : scene.obstacles) {
      const double speed_mps = (obstacle.at(2.0).centre() - obstacle.at(1.0).centre()).norm();
      check(speed_mps >= 0.1 - 1e-9 && speed_mps <= 0.5 + 1e-9, "%g m/s", speed_mps);
      for (double t_s = 0.0; t_s <= scene.duration_s(); t_s += 0.01) {
        const Capsule capsule = obstacle.at(t_s);
        for (double z_m = 0.0; z_m <= 0.3; z_m += 0.01) {
          const Vector3 nearest_m = sidestep::nearest_on_segment(capsule.start, capsule.end, Vector3(0, 0, z_m));
          check((nearest_m - Vector3(0, 0, z_m)).norm() >= 0.15 + 0.05 + capsule.radius_m - 0.005, "at %g s", t_s);
        }
      }
    }
  }
}

void every_drawn_obstacle_crosses_a_moving_link_and_has_passed_at_the_end(void**) {
  Random random("test", 9);
  for (int k = 0; k < 20; ++k) {
    const SearchScene scene = draw_search_scene(random, {SearchFamily::kRest, 2, 0.5, limits()});
    const ArmPose pose = lwa3_arm().pose(scene.start_rad);
    for (const MovingCapsule& obstacle : scene.obstacles) {
      double least_m = 1e9;
      for (size_t link = 1; link + 1 < pose.corners.size(); ++link) {
        const Vector3 nearest_m =
            sidestep::nearest_on_segment(pose.corners[link], pose.corners[link + 1], obstacle.crossing_m);
        least_m = std::min(least_m, (nearest_m - obstacle.crossing_m).norm());
      }
      check_near(least_m, 0.0, 1e-9);
      check_near(obstacle.at(obstacle.crossing_s).centre(), obstacle.crossing_m, 1e-12);
      check((obstacle.at(scene.duration_s()).centre() - obstacle.crossing_m).norm() >= 0.8 - 1e-9, "has not passed");
    }
  }
}

void the_start_is_within_the_limits_and_free_of_self_collision(void**) {
  for (const SearchScene& scene : scenes()) {
    check((limits().upper_rad - scene.start_rad).minCoeff() >= 0.0, "above a limit");
    check((scene.start_rad - limits().lower_rad).minCoeff() >= 0.0, "below a limit");
    check(lwa3_arm().self_clearance(lwa3_arm().pose(scene.start_rad)) >= 0.02, "self-collision");
  }
  Joints folded_rad = Joints::Zero(7);
  folded_rad[1] = folded_rad[3] = folded_rad[5] = 1.97;  // the hand returns to the upper arm
  const double folded_m = lwa3_arm().self_clearance(lwa3_arm().pose(folded_rad));
  check(folded_m < 0.02, "%g m", folded_m);
}

void the_same_seed_gives_the_same_scene_and_a_mutation_another(void**) {
  const SearchSpace space{SearchFamily::kRest, 3, 0.5, limits()};
  Random a("test", 1), b("test", 1);
  const SearchScene first = draw_search_scene(a, space), again = draw_search_scene(b, space);
  check_near(first.start_rad, again.start_rad, 0.0);
  check_near(first.obstacles[2].crossing_m, again.obstacles[2].crossing_m, 0.0);
  const SearchScene changed = mutated(a, space, first);
  check(changed.obstacles.size() == 3, "%zu obstacles", changed.obstacles.size());
  double change_m = 0.0;
  for (size_t i = 0; i < 3; ++i) change_m += (changed.obstacles[i].crossing_m - first.obstacles[i].crossing_m).norm();
  check(change_m > 0.0 && change_m < 0.6, "%g m", change_m);
}

void scenes_against_the_rules_are_recognised(void**) {
  const SearchScene drawn = scenes().front();
  check(is_valid(drawn, limits(), 0.5), "the drawn scene is valid");
  check(!is_valid(drawn, limits(), 0.9 * drawn.obstacles[0].velocity_mps.norm()), "too fast");
  SearchScene near = drawn;
  near.obstacles[0].crossing_s = 0.1;
  check(!is_valid(near, limits(), 0.5), "too near");
  SearchScene column = drawn;
  column.obstacles[0].crossing_m = {0.0, 0.0, 0.15};
  column.obstacles[0].velocity_mps = {0.4, 0.0, 0.0};
  check(!is_valid(column, limits(), 0.5), "through the column");
  SearchScene beyond = drawn;
  beyond.start_rad[1] = 2.0;
  check(!is_valid(beyond, limits(), 0.5), "beyond a joint limit");
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(distances_agree_with_fcl_and_the_urdf),
      cmocka_unit_test(no_obstacle_is_nearer_than_half_a_metre_at_first),
      cmocka_unit_test(obstacles_keep_their_speed_and_miss_the_base_column),
      cmocka_unit_test(every_drawn_obstacle_crosses_a_moving_link_and_has_passed_at_the_end),
      cmocka_unit_test(the_start_is_within_the_limits_and_free_of_self_collision),
      cmocka_unit_test(the_same_seed_gives_the_same_scene_and_a_mutation_another),
      cmocka_unit_test(scenes_against_the_rules_are_recognised),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
