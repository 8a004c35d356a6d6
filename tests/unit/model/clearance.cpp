#include "firmware/model/clearance.h"

#include <algorithm>
#include <memory>
#include <vector>

#include "tests/support/check.h"
#include "tests/support/fcl_distance.h"
#include "tests/support/lwa3.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::fcl_distance_m;
using test::home_rad;
using test::lwa3;
using test::Random;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A sphere, a capsule or a box at rest.
Obstacle random_shape(Random& random, double reach_m) {
  const Vector3 centre = random.inside(-reach_m, reach_m);
  const Matrix3 rotation = random.turn().toRotationMatrix();
  const double largest_m = random.chance(0.1) ? 0.4 * reach_m : 0.1, radius_m = random.uniform(0.01, largest_m);
  switch (random.index(4)) {
    case 0:
      return sphere_obstacle(centre, radius_m);
    case 1:
      return capsule_obstacle(centre, rotation, radius_m, random.uniform(0.01, 0.6));
    case 2:
      return cylinder_obstacle(centre, rotation, radius_m, random.uniform(0.01, 0.6));
    default:
      return box_obstacle(centre, rotation, random.inside(0.01, 5.0 * largest_m));
  }
}

bool is_solid(const Obstacle& obstacle) {
  return obstacle.shape == Shape::kBox || obstacle.shape == Shape::kCylinder;
}

Obstacle random_obstacle(Random& random, double reach_m) {
  Obstacle obstacle = random_shape(random, reach_m);
  obstacle.id = random.index(1000000);
  obstacle.velocity_mps = random.inside(-1, 1);
  obstacle.angular_velocity_radps = random.inside(-2, 2);
  return obstacle;
}

std::unique_ptr<ObstacleSet> random_set(Random& random, int count, double reach_m) {
  auto set = std::make_unique<ObstacleSet>();
  set->count = count;
  for (int i = 0; i < count; ++i) set->obstacles[static_cast<size_t>(i)] = random_obstacle(random, reach_m);
  return set;
}

/// Every link shape with every obstacle, none skipped.
std::vector<NearPair> all_pairs(const LinkPoses& poses, const ObstacleView& view, double horizon_s) {
  std::vector<NearPair> pairs;
  for (int o = 0; o < view.set->count; ++o) {
    Obstacle present = extrapolated(view.set->obstacles[static_cast<size_t>(o)], view.age_s);
    present.capsule.radius_m += view.growth_m;
    for (int s = 0; s < static_cast<int>(lwa3().shapes.size()); ++s) {
      const Capsule link = transformed(poses, lwa3().shapes[static_cast<size_t>(s)]);
      const Proximity now = measure_pair(link, present);
      NearPair pair{now, predict_closest_approach(link, present, now, horizon_s)};
      pair.now.shape = s;
      pair.now.obstacle = o;
      pairs.push_back(pair);
    }
  }
  return pairs;
}

bool moves(const NearPair& pair) {
  return lwa3().shapes[static_cast<size_t>(pair.now.shape)].body > 0;
}

double least_distance_m(const NearPair& pair) {
  return std::min(pair.now.distance_m, pair.approach.distance_m);
}

void distance_of_a_pair_agrees_with_fcl(void**) {
  Random random(1);
  int compared = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const Capsule a = random_shape(random, 0.5).capsule;
    const Obstacle b = random_shape(random, 0.5);
    const double distance_m = fcl_distance_m(a, b);
    const Proximity pair = measure_pair(a, b);
    check((pair.distance_m > 0) == (distance_m > 0), "trial %d", trial);
    if (distance_m <= 0) continue;
    check_near_because(pair.distance_m, distance_m, 1e-6, "trial %d", trial);
    ++compared;
  }
  check(compared > 1000, "%d compared", compared);
}

void normal_points_from_the_obstacle_to_the_arm(void**) {
  Random random(2);
  for (int trial = 0; trial < 1000; ++trial) {
    const Capsule link = random_shape(random, 0.5).capsule;
    const Obstacle obstacle = random_shape(random, 0.5);
    const double radius_m = is_solid(obstacle) ? 0.0 : obstacle.capsule.radius_m;
    const Proximity pair = measure_pair(link, obstacle);
    check_near_because(pair.on_obstacle + pair.axis_distance_m * pair.normal, pair.on_arm, 1e-9, "trial %d", trial);
    check_near_because(pair.distance_m, pair.axis_distance_m - link.radius_m - radius_m, 1e-15, "trial %d", trial);
  }
}

void normal_is_a_unit_vector_across_the_link_where_the_axes_meet(void**) {
  const Capsule link{Vector3(0, 0, 0), Vector3(1, 0, 0), 0.05}, point{Vector3(0.5, 0, 0), Vector3(0.5, 0, 0), 0.05};
  const Proximity on_axis = measure_pair(link, point);
  check_near(on_axis.normal.norm(), 1.0, 1e-12);
  check_near(on_axis.normal.dot(Vector3::UnitX()), 0.0, 1e-12);
  check_near(on_axis.distance_m, -0.1, 1e-12);
  check_near(measure_pair(point, point).normal.norm(), 1.0, 1e-12);
}

/// Equal up to rounding; both may be infinite.
void check_same(double actual, double expected, int trial) {
  if (actual != expected) check_near_because(actual, expected, 1e-12, "trial %d", trial);
}

void nearest_is_the_true_minimum_among_many(void**) {
  Random random(3);
  for (int trial = 0; trial < 300; ++trial) {
    const auto set = random_set(random, 1 + random.index(60), trial % 3 ? 1.5 : 8.0);
    const ObstacleView view{set.get(), random.uniform(0, 0.3), random.chance(0.3) ? random.uniform(0, 0.5) : 0.0};
    const LinkPoses poses = forward_kinematics(lwa3(), random.configuration(lwa3()));
    const Reach reach{random.uniform(0, 0.5), random.uniform(0, 1)};
    const Clearance clearance = measure_clearance(lwa3(), poses, view, reach);
    double least = kInfinity, least_axis = kInfinity;
    for (const NearPair& pair : all_pairs(poses, view, reach.horizon_s)) {
      least = std::min(least, pair.now.distance_m);
      if (moves(pair)) least_axis = std::min(least_axis, pair.now.axis_distance_m);
    }
    check_same(clearance.nearest.distance_m, least, trial);
    check_same(clearance.nearest_axis.axis_distance_m, least_axis, trial);
  }
}

void the_near_list_holds_the_pairs_within_reach_and_the_nearest_of_too_many(void**) {
  Random random(4);
  int overfull = 0, partly = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const auto set = random_set(random, 1 + random.index(trial % 2 ? 300 : 20), 1.2);
    const ObstacleView view{set.get(), 0.05, 0.0};
    const LinkPoses poses = forward_kinematics(lwa3(), random.configuration(lwa3()));
    const Reach reach{random.uniform(0.05, 0.5), random.uniform(0, 1)};
    const Clearance clearance = measure_clearance(lwa3(), poses, view, reach);
    std::vector<double> expected, actual;
    for (const NearPair& pair : all_pairs(poses, view, reach.horizon_s))
      if (moves(pair) && least_distance_m(pair) < reach.range_m) expected.push_back(least_distance_m(pair));
    for (const NearPair& pair : clearance.near) actual.push_back(least_distance_m(pair));
    std::sort(expected.begin(), expected.end());
    std::sort(actual.begin(), actual.end());
    (expected.size() > kMaxNear ? overfull : partly) += !expected.empty();
    if (expected.size() > kMaxNear) expected.resize(kMaxNear);
    check(actual.size() == expected.size(), "trial %d: %zu near pairs, expected %zu", trial, actual.size(),
          expected.size());
    for (size_t i = 0; i < expected.size(); ++i) check_same(actual[i], expected[i], trial);
  }
  check(overfull > 5 && partly > 5, "%d overfull, %d partly filled", overfull, partly);
}

/// Among more pairs than the list holds those are kept that have the least distance when the arm has stopped.
void the_near_list_of_an_arm_that_moves_holds_what_it_comes_to(void**) {
  Random random(9);
  int overfull = 0, different = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const auto set = random_set(random, 100 + random.index(300), 1.2);
    const ObstacleView view{set.get(), 0.05, 0.0};
    const LinkPoses poses = forward_kinematics(lwa3(), random.configuration(lwa3()));
    const JointVector velocity_radps = random.joints(7, -1.5, 1.5);
    const Reach reach{0.4, 0.5, 0.0, &velocity_radps, random.uniform(0.0, 0.3)};
    const auto margin_m = [&](const NearPair& pair) {
      const int body = lwa3().shapes[static_cast<size_t>(pair.now.shape)].body;
      const Vector3 link_mps = point_velocity(poses, body, pair.now.on_arm, velocity_radps);
      return least_distance_m(pair) - std::max(0.0, -pair.now.normal.dot(link_mps)) * reach.stopping_s;
    };
    std::vector<double> expected, actual, at_rest;
    for (const NearPair& pair : all_pairs(poses, view, reach.horizon_s))
      if (moves(pair) && least_distance_m(pair) < reach.range_m) expected.push_back(margin_m(pair));
    for (const NearPair& pair : measure_clearance(lwa3(), poses, view, reach).near) actual.push_back(margin_m(pair));
    for (const NearPair& pair : measure_clearance(lwa3(), poses, view, {0.4, 0.5}).near)
      at_rest.push_back(margin_m(pair));
    if (expected.size() <= kMaxNear) continue;
    ++overfull;
    std::sort(expected.begin(), expected.end());
    std::sort(actual.begin(), actual.end());
    std::sort(at_rest.begin(), at_rest.end());
    assert_int_equal(actual.size(), kMaxNear);
    for (size_t i = 0; i < actual.size(); ++i) check_near_because(actual[i], expected[i], 1e-9, "trial %d", trial);
    different += at_rest.back() > actual.back() + 1e-6;
  }
  check(overfull > 50 && different > 25, "%d overfull, %d differ from those of an arm at rest", overfull, different);
}

/// Spheres take a faster computation than other shapes, above all receding ones.
void a_near_pair_has_the_values_of_the_general_computation(void**) {
  Random random(7);
  int receding = 0, coming = 0;
  for (int trial = 0; trial < 600; ++trial) {
    const auto set = random_set(random, 1 + random.index(20), 1.0);
    const ObstacleView view{set.get(), 0.05, 0.01};
    const LinkPoses poses = forward_kinematics(lwa3(), random.configuration(lwa3()));
    const Reach reach{0.4, 0.5};
    const std::vector<NearPair> all = all_pairs(poses, view, reach.horizon_s);
    for (const NearPair& pair : measure_clearance(lwa3(), poses, view, reach).near) {
      const NearPair& other = *std::find_if(all.begin(), all.end(), [&](const NearPair& p) {
        return p.now.shape == pair.now.shape && p.now.obstacle == pair.now.obstacle;
      });
      const double rounding = 1e-9;
      check_same(pair.now.distance_m, other.now.distance_m, trial);
      check_same(pair.now.axis_distance_m, other.now.axis_distance_m, trial);
      check((pair.now.on_arm - other.now.on_arm).norm() < rounding, "trial %d", trial);
      check((pair.now.on_obstacle - other.now.on_obstacle).norm() < rounding, "trial %d", trial);
      check((pair.now.normal - other.now.normal).norm() < rounding, "trial %d", trial);
      check_same(pair.approach.distance_m, other.approach.distance_m, trial);
      check_same(pair.approach.axis_distance_m, other.approach.axis_distance_m, trial);
      check((pair.approach.on_arm - other.approach.on_arm).norm() < 1e-6, "trial %d", trial);
      check_near_because(pair.approach.time_s, other.approach.time_s, 1e-6, "trial %d", trial);
      const bool is_sphere = set->obstacles[static_cast<size_t>(pair.now.obstacle)].capsule.is_sphere();
      (pair.approach.time_s > 0.0 ? coming : receding) += is_sphere;
      if (pair.approach.time_s == 0.0) continue;  // its normal is not used
      assert_int_equal(pair.approach.head_on, other.approach.head_on);
      check((pair.approach.normal - other.approach.normal).norm() < rounding, "trial %d", trial);
    }
  }
  check(receding > 200 && coming > 200, "%d spheres recede, %d come", receding, coming);
}

void obstacles_are_extrapolated_by_their_age_and_grown(void**) {
  auto set = std::make_unique<ObstacleSet>();
  set->count = 1;
  set->obstacles[0].id = 7;
  set->obstacles[0].capsule = {Vector3(0, 0, 2.0), Vector3(0, 0, 2.0), 0.05};
  set->obstacles[0].velocity_mps = Vector3(0, 0, -0.5);
  JointVector upright = JointVector::Zero(7);
  const LinkPoses poses = forward_kinematics(lwa3(), upright);
  const double top_m = poses.tool_position.z();
  const auto clearance_m = [&](double age_s, double growth_m) {
    return measure_clearance(lwa3(), poses, {set.get(), age_s, growth_m}, {0.4, 0.0}).nearest.distance_m;
  };
  check_near(clearance_m(0.0, 0.0), 2.0 - top_m - 0.1, 1e-12);
  check_near(clearance_m(0.2, 0.0), 2.0 - top_m - 0.1 - 0.1, 1e-12);
  check_near(clearance_m(0.2, 0.3), 2.0 - top_m - 0.1 - 0.1 - 0.3, 1e-12);
}

void the_base_column_counts_for_the_surface_distance_but_not_for_the_axis_distance(void**) {
  auto set = std::make_unique<ObstacleSet>();
  set->count = 1;
  set->obstacles[0].capsule = {Vector3(0.2, 0, 0.1), Vector3(0.2, 0, 0.1), 0.05};
  const Clearance clearance =
      measure_clearance(lwa3(), forward_kinematics(lwa3(), home_rad()), {set.get(), 0, 0}, {0.4, 0.0});
  check_near(clearance.nearest.distance_m, 0.1, 1e-12);
  assert_int_equal(lwa3().shapes[static_cast<size_t>(clearance.nearest.shape)].body, 0);
  assert_true(lwa3().shapes[static_cast<size_t>(clearance.nearest_axis.shape)].body > 0);
  check_near(clearance.nearest_axis.axis_distance_m, std::hypot(0.2, 0.2), 1e-12);
}

void without_obstacles_there_is_no_nearest_pair(void**) {
  const auto empty = std::make_unique<ObstacleSet>();
  for (const ObstacleView& view : {ObstacleView{}, ObstacleView{empty.get(), 0.1, 0.1}}) {
    const Clearance clearance = measure_clearance(lwa3(), forward_kinematics(lwa3(), home_rad()), view, {0.4, 1.0});
    assert_int_equal(clearance.nearest.shape, -1);
    assert_int_equal(clearance.nearest_axis.shape, -1);
    assert_int_equal(clearance.near.size(), 0);
    check_near(clearance.nearest.distance_m, kInfinity, 0);
  }
}

/// The distance after time_s to what predict_closest_approach() follows: of a sphere or a capsule the point that is
/// nearest now, of a box or cylinder the whole.
double distance_after_m(const Capsule& link, const Obstacle& obstacle, const Proximity& now, double time_s) {
  const Vector3 shift = time_s * velocity_at(obstacle, now.on_obstacle);
  Obstacle then = is_solid(obstacle) ? obstacle : sphere_obstacle(now.on_obstacle, obstacle.capsule.radius_m);
  then.capsule.start += shift;
  then.capsule.end += shift;
  return measure_pair(link, then).distance_m;
}

void closest_approach_is_the_least_distance_within_the_horizon(void**) {
  Random random(5);
  int solids = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    const Capsule link = random_shape(random, 0.5).capsule;
    const Obstacle obstacle = random_obstacle(random, 1.0);
    const double horizon_s = random.uniform(0.1, 1.0);
    const Proximity now = measure_pair(link, obstacle);
    const ClosestApproach approach = predict_closest_approach(link, obstacle, now, horizon_s);
    check(approach.time_s >= 0 && approach.time_s <= horizon_s + 1e-12, "trial %d: time %g", trial, approach.time_s);
    check_near_because(distance_after_m(link, obstacle, now, approach.time_s), approach.distance_m, 1e-9, "trial %d",
                       trial);
    const double slack_m = is_solid(obstacle) ? 0.02 : 1e-9;
    for (int i = 0; i <= 50; ++i)
      check(distance_after_m(link, obstacle, now, i * horizon_s / 50) >= approach.distance_m - slack_m,
            "trial %d, sample %d", trial, i);
    check_near_because(approach.normal.norm(), 1.0, 1e-9, "trial %d", trial);
    solids += is_solid(obstacle) && approach.time_s > 0.0;
  }
  check(solids > 100, "only %d boxes and cylinders come closer", solids);
}

void static_obstacles_always_count_and_neither_move_nor_grow(void**) {
  const std::vector<Obstacle> surroundings{box_obstacle(Vector3(0, 0, 2), Matrix3::Identity(), Vector3(1, 1, 0.2))};
  const auto set = std::make_unique<ObstacleSet>();
  const LinkPoses poses = forward_kinematics(lwa3(), JointVector::Zero(7));
  const double expected_m = 1.9 - poses.tool_position.z() - 0.05;
  for (const ObstacleView& view :
       {ObstacleView{nullptr, 0, 0, &surroundings}, ObstacleView{set.get(), 0.3, 0.4, &surroundings}}) {
    const Clearance clearance = measure_clearance(lwa3(), poses, view, {0.4, 0.0});
    check_near(clearance.nearest.distance_m, expected_m, 1e-12);
    assert_int_equal(clearance.nearest.obstacle, 0);
  }
}

void the_velocity_of_a_pair_is_that_of_the_material_at_the_nearest_point(void**) {
  auto set = std::make_unique<ObstacleSet>();
  set->count = 1;
  set->obstacles[0] = box_obstacle(Vector3(0.3, 0, 1.5), Matrix3::Identity(), Vector3(1, 0.2, 0.1));
  set->obstacles[0].velocity_mps = Vector3(0, 0.1, 0);
  set->obstacles[0].angular_velocity_radps = Vector3(0, 2, 0);
  const Clearance clearance =
      measure_clearance(lwa3(), forward_kinematics(lwa3(), JointVector::Zero(7)), {set.get(), 0, 0}, {0.4, 0.0});
  assert_true(clearance.near.size() > 0);
  const NearPair& pair = clearance.near[0];
  const Vector3 arm = pair.now.on_obstacle - Vector3(0.3, 0, 1.5);
  check_near(pair.velocity_mps, Vector3(2 * arm.z(), 0.1, -2 * arm.x()), 1e-12);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(distance_of_a_pair_agrees_with_fcl),
      cmocka_unit_test(normal_points_from_the_obstacle_to_the_arm),
      cmocka_unit_test(normal_is_a_unit_vector_across_the_link_where_the_axes_meet),
      cmocka_unit_test(nearest_is_the_true_minimum_among_many),
      cmocka_unit_test(the_near_list_holds_the_pairs_within_reach_and_the_nearest_of_too_many),
      cmocka_unit_test(the_near_list_of_an_arm_that_moves_holds_what_it_comes_to),
      cmocka_unit_test(a_near_pair_has_the_values_of_the_general_computation),
      cmocka_unit_test(obstacles_are_extrapolated_by_their_age_and_grown),
      cmocka_unit_test(the_base_column_counts_for_the_surface_distance_but_not_for_the_axis_distance),
      cmocka_unit_test(without_obstacles_there_is_no_nearest_pair),
      cmocka_unit_test(closest_approach_is_the_least_distance_within_the_horizon),
      cmocka_unit_test(static_obstacles_always_count_and_neither_move_nor_grow),
      cmocka_unit_test(the_velocity_of_a_pair_is_that_of_the_material_at_the_nearest_point),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
