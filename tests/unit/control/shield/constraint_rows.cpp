#include "firmware/control/shield/constraint_rows.h"

#include "firmware/control/shield/required_clearance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>

#include "firmware/model/load/self_pairs.h"
#include "firmware/model/turning_proximity.h"
#include "tests/support/check.h"
#include "tests/support/lwa3.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::lwa3;
using test::Random;

namespace {

constexpr double kStep_rad = 1e-6;
constexpr double kTolerance = 1e-6;
constexpr double kKink_m = 0.01;  // for axes nearer than this the distance is too curved to differentiate

const ShieldSettings kSettings;

VelocityRange range_of(double radps) {
  return {JointVector::Constant(7, -radps), JointVector::Constant(7, radps)};
}

/// A configuration among obstacles, and its constraint rows.
struct Scene {
  JointVector q_rad, commanded_rad, last_radps = JointVector::Zero(7), nominal_radps = JointVector::Zero(7);
  LinkPoses poses;
  std::unique_ptr<ObstacleSet> set = std::make_unique<ObstacleSet>();
  Clearance clearance;
  std::vector<SelfPair> self_pairs;
  double person_weight = 0.0;

  explicit Scene(const JointVector& q) : q_rad(q), commanded_rad(q), poses(forward_kinematics(lwa3(), q)) {
    for (const LinkShape& shape : lwa3().shapes) clearance.links.add(transformed(poses, shape));
  }

  void add(const Obstacle& obstacle) { set->obstacles[static_cast<size_t>(set->count++)] = obstacle; }
  RowSets row_sets(const VelocityRange& sustainable, const VelocityRange& range) const {
    const ObstacleView view{set.get(), 0.0, 0.0};
    const ShieldInput now{lwa3(),     poses,      q_rad, commanded_rad, last_radps, clearance,    view,
                          self_pairs, last_radps, 0.01,  1.0,           0.0,        person_weight};
    return make_rows(kSettings, now, sustainable, range, nominal_radps);
  }
  ConstraintRows rows(const VelocityRange& range, bool hard_only = false) const {
    const RowSets rows = row_sets(range, range);
    return hard_only ? rows.step : rows.plan;
  }
  /// The rows of one pair, none of them dropped.
  ConstraintRows rows_of(const NearPair& pair, bool hard_only = false) {
    clearance.near.clear();
    clearance.near.add(pair);
    return rows(range_of(1e9), hard_only);
  }
};

/// Bound of a hard row. The closing speed is at most the gain times the room, and low enough to brake within the room
/// at half of the joints' acceleration after one more period.
double hard_bound(const JointVector& row, double room_m) {
  const double by_gain_mps = kSettings.hard_gain_per_s * room_m;
  if (room_m <= 0.0) return std::min(3.0, -by_gain_mps);
  const double b = 0.5 * row.cwiseAbs().dot(lwa3().limits.acceleration_radps2), period_s = 0.01;
  return -std::min(by_gain_mps, -b * period_s + std::sqrt(b * b * period_s * period_s + 2.0 * b * room_m));
}

/// False where no joint changes the distance, as for a link that turns about its own axis. Such a row is skipped if it
/// is met.
bool joints_matter(const JointVector& by_joint) {
  return by_joint.norm() > 1e-6;
}

/// Derivative of a distance by the joints, by central differences.
JointVector gradient(const JointVector& q_rad, const std::function<double(const LinkPoses&)>& distance_m) {
  JointVector by_joint(q_rad.size());
  for (int i = 0; i < q_rad.size(); ++i) {
    JointVector more = q_rad, less = q_rad;
    more[i] += kStep_rad;
    less[i] -= kStep_rad;
    by_joint[i] = (distance_m(forward_kinematics(lwa3(), more)) - distance_m(forward_kinematics(lwa3(), less))) /
                  (2.0 * kStep_rad);
  }
  return by_joint;
}

const LinkShape& shape_of(int index) {
  return lwa3().shapes[static_cast<size_t>(index)];
}

Obstacle random_shape(const Vector3& centre, Random& random) {
  const Matrix3 rotation = random.turn().toRotationMatrix();
  if (random.chance(0.4)) return sphere_obstacle(centre, random.uniform(0, 0.15));
  if (random.chance(0.5)) return capsule_obstacle(centre, rotation, random.uniform(0, 0.15), random.uniform(0, 0.6));
  return box_obstacle(centre, rotation, random.inside(0.01, 0.5));
}

/// A random obstacle, at rest or moving, from deep inside the link to the end of the range.
Obstacle random_obstacle(const Capsule& link, Random& random) {
  Obstacle obstacle = random_shape(
      link.start + random.uniform(0, 1) * (link.end - link.start) + random.direction() * random.uniform(0, 0.4),
      random);
  if (random.chance(0.7)) obstacle.velocity_mps = random.inside(-1, 1);
  return obstacle;
}

NearPair pair_of(const LinkPoses& poses, int shape, int index, const Obstacle& obstacle) {
  const Capsule link = transformed(poses, shape_of(shape));
  const Proximity now = measure_pair(link, obstacle);
  NearPair pair{now, predict_closest_approach(link, obstacle, now, kSettings.pass_horizon_s),
                velocity_at(obstacle, now.on_obstacle)};
  pair.now.shape = shape;
  pair.now.obstacle = index;
  return pair;
}

int moving_shape(Random& random) {
  int shape = 0;
  while (shape_of(shape).body == 0) shape = random.index(static_cast<int>(lwa3().shapes.size()));
  return shape;
}

void check_distance_rows(Scene& scene, const NearPair& pair, const Obstacle& obstacle, int trial, int (&seen)[2]) {
  const JointVector expected = gradient(scene.q_rad, [&](const LinkPoses& poses) {
    return measure_pair(transformed(poses, shape_of(pair.now.shape)), obstacle).distance_m;
  });
  const ConstraintRows rows = scene.rows_of(pair);
  for (const ConstraintRow& row : rows) {
    if (row.tier == Tier::kPass) continue;
    check_near_because(row.row, expected, kTolerance, "trial %d, d = %g m", trial, pair.now.distance_m);
    ++seen[row.tier == Tier::kComfort];
  }
}

void distance_rows_are_the_gradients_of_the_distances(void**) {
  Random random(1);
  int seen[2] = {}, inside = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    Scene scene(random.configuration(lwa3()));
    const int shape = moving_shape(random);
    const Obstacle obstacle = random_obstacle(transformed(scene.poses, shape_of(shape)), random);
    scene.add(obstacle);
    const NearPair pair = pair_of(scene.poses, shape, 0, obstacle);
    if (std::abs(pair.now.axis_distance_m) < kKink_m || pair.now.distance_m > kSettings.range_m) continue;
    check_distance_rows(scene, pair, obstacle, trial, seen);
    if (pair.now.distance_m < 0.0) ++inside;
  }
  check(seen[0] > 2000 && seen[1] > 2000 && inside > 300, "%d hard, %d comfort, %d inside", seen[0], seen[1], inside);
}

/// d' >= -gain (d - clearance) for an obstacle at rest, limited to a speed that an arm can reach.
void the_bounds_of_distance_rows_are_barriers(void**) {
  Random random(2);
  for (int trial = 0; trial < 500; ++trial) {
    Scene scene(random.configuration(lwa3()));
    const int shape = moving_shape(random);
    Obstacle obstacle = random_obstacle(transformed(scene.poses, shape_of(shape)), random);
    obstacle.velocity_mps.setZero();
    scene.add(obstacle);
    const NearPair pair = pair_of(scene.poses, shape, 0, obstacle);
    const ConstraintRows rows = scene.rows_of(pair);
    const double d = pair.now.distance_m;
    if (d > kSettings.range_m) {
      assert_int_equal(rows.size(), 0);
      continue;
    }
    const PointJacobian jacobian = point_jacobian(scene.poses, shape_of(shape).body, pair.now.on_arm);
    if (!joints_matter(jacobian.transpose() * pair.now.normal)) continue;
    assert_int_equal(rows.size(), 2);
    check_near(rows[0].bound, hard_bound(rows[0].row, d - kSettings.rest_clearance_m), 1e-9);
    check_near(rows[1].bound, std::min(3.0, -kSettings.comfort_gain_per_s * (d - kSettings.comfort_clearance_m)), 1e-9);
  }
}

/// The part of the following error that closes the pair is taken from its room, at most 0.1 s times the closing speed:
/// an arm at rest beside its command stays there.
void a_command_ahead_of_the_arm_takes_room_from_what_it_approaches(void**) {
  Random random(13);
  int less = 0, capped = 0, same = 0;
  for (int trial = 0; trial < 500; ++trial) {
    Scene scene(random.configuration(lwa3()));
    const int shape = moving_shape(random);
    Obstacle obstacle = random_obstacle(transformed(scene.poses, shape_of(shape)), random);
    obstacle.velocity_mps.setZero();
    obstacle.kind = Kind::kPerson;  // needs the same clearance from a link of any speed
    scene.add(obstacle);
    const NearPair pair = pair_of(scene.poses, shape, 0, obstacle);
    const PointJacobian jacobian = point_jacobian(scene.poses, shape_of(shape).body, pair.now.on_arm);
    if (pair.now.distance_m > kSettings.range_m || !joints_matter(jacobian.transpose() * pair.now.normal)) continue;
    for (int i = 0; i < 7; ++i) {
      scene.commanded_rad[i] += random.uniform(-0.1, 0.1);
      scene.last_radps[i] = random.uniform(-1, 1);
    }
    const JointVector row = scene.rows_of(pair)[0].row;
    const double ahead_m = -row.dot(scene.commanded_rad - scene.q_rad), fastest_m = -0.1 * row.dot(scene.last_radps);
    const double taken_m = std::max(0.0, std::min(ahead_m, fastest_m));
    ++(taken_m == 0.0 ? same : taken_m == ahead_m ? less : capped);
    const double room_m = pair.now.distance_m - taken_m - kSettings.hard_clearance_m;
    check_near(scene.rows_of(pair)[0].bound, hard_bound(row, room_m), 1e-9);
  }
  check(less > 30 && capped > 30 && same > 100, "%d less, %d capped, %d the same", less, capped, same);
}

/// In place of comfort: the barrier of persons, who count as approaching by 1 m/s at most, less of it from a slow link,
/// and no more than it can do, weighed.
void a_person_has_a_row_of_separation(void**) {
  constexpr double kWeight = 250.0;
  const VelocityRange range = range_of(1.5);
  Random random(12);
  int capped = 0, met = 0, fast = 0;
  for (int trial = 0; trial < 500; ++trial) {
    Scene scene(random.configuration(lwa3()));
    const int shape = moving_shape(random);
    Obstacle obstacle = random_obstacle(transformed(scene.poses, shape_of(shape)), random);
    obstacle.velocity_mps *= 2.0;
    obstacle.kind = Kind::kPerson;
    scene.add(obstacle);
    const NearPair pair = pair_of(scene.poses, shape, 0, obstacle);
    const PointJacobian jacobian = point_jacobian(scene.poses, shape_of(shape).body, pair.now.on_arm);
    const JointVector row = jacobian.transpose() * pair.now.normal;
    const double most_mps = 1.5 * row.cwiseAbs().sum();
    if (most_mps < 0.05) continue;
    const double approaching_mps = pair.now.normal.dot(pair.velocity_mps);
    fast += approaching_mps > 1.0;
    const double demand_mps = std::min(approaching_mps, 1.0) -
                              kSettings.person_gain_per_s * (pair.now.distance_m - kSettings.person_clearance_m);
    scene.person_weight = kWeight;
    scene.clearance.near.clear();
    scene.clearance.near.add(pair);
    const ConstraintRows rows = scene.rows(range);
    const auto separation =
        std::find_if(rows.begin(), rows.end(), [](const ConstraintRow& r) { return r.tier == Tier::kComfort; });
    const double share = std::min(1.0, most_mps / (kSettings.person_gain_per_s * kSettings.person_clearance_m));
    if (share * demand_mps <= -most_mps) {
      assert_true(separation == rows.end());
      ++met;
      continue;
    }
    assert_true(separation != rows.end());
    const double scale = std::sqrt(kWeight);
    check_near(separation->row, JointVector(scale * row), 1e-6 * scale);
    check_near(separation->bound, scale * std::min(share * demand_mps, most_mps), 1e-6 * scale);
    capped += share * demand_mps > most_mps;
  }
  check(capped > 20 && fast > 20, "%d capped, %d met, %d fast", capped, met, fast);
}

VelocityRange random_range(Random& random, double largest_radps) {
  const JointVector middle = random.joints(7, -largest_radps, largest_radps);
  return {middle - random.joints(7, 0, 0.5), middle + random.joints(7, 0, 0.5)};
}

double most_mps(const JointVector& row, const VelocityRange& range) {
  double sum_mps = 0.0;
  for (int i = 0; i < 7; ++i) sum_mps += std::max(row[i] * range.lower_radps[i], row[i] * range.upper_radps[i]);
  return sum_mps;
}

/// Beside that, a person who is near has a row of 64 times the weight, which only keeps the arm from approaching: to
/// the clearance, while it keeps separation to 0.1 m more. That the person recedes gives it no room. In the coming
/// period the row asks for no more than some velocity within the range gives.
void a_near_person_has_a_row_against_the_approach_of_the_arm_itself(void**) {
  Random random(12);
  int seen[2] = {}, far[2] = {}, braking = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    Scene scene(random.configuration(lwa3()));
    const int shape = moving_shape(random), separates = trial % 2;
    Obstacle obstacle = random_obstacle(transformed(scene.poses, shape_of(shape)), random);
    if (obstacle.shape == Shape::kBox) continue;
    scene.person_weight = separates;
    obstacle.kind = Kind::kPerson;
    scene.add(obstacle);
    const NearPair pair = pair_of(scene.poses, shape, 0, obstacle);
    const PointJacobian jacobian = point_jacobian(scene.poses, shape_of(shape).body, pair.now.on_arm);
    const JointVector row = jacobian.transpose() * pair.now.normal;
    const ConstraintRows rows = scene.rows_of(pair, true);
    const double room_m = pair.now.distance_m - kSettings.hard_clearance_m - 0.1 * separates;
    const double bound_mps = std::min(0.0, hard_bound(row, room_m));
    const auto has = [&](const ConstraintRows& among, double wanted_mps) {
      return std::any_of(among.begin(), among.end(), [&](const ConstraintRow& one) {
        return (one.row - 64.0 * row).norm() < 1e-5 && std::abs(one.bound - 64.0 * wanted_mps) < 1e-5;
      });
    };
    const bool found = has(rows, bound_mps);
    if (!joints_matter(row)) continue;
    const VelocityRange range = random_range(random, 2.0);
    const double largest_mps = most_mps(row, range);
    if (room_m <= 0.05 && largest_mps < bound_mps) {
      const VelocityRange sustainable{JointVector::Constant(7, -2.0), JointVector::Constant(7, 2.0)};
      check(has(scene.row_sets(sustainable, range).step, largest_mps), "trial %d: not %g m/s", trial, largest_mps);
      ++braking;
    }
    if (room_m > 0.05) {
      assert_false(found);
      ++far[separates];
    } else {
      check(found, "trial %d: %g m", trial, room_m);
      ++seen[separates];
    }
  }
  for (const int separates : {0, 1})
    check(seen[separates] > 50 && far[separates] > 20, "%d near, %d far", seen[separates], far[separates]);
  check(braking > 20, "only %d beyond the range", braking);
}

/// The bound grows with the velocity of the obstacle toward the link.
void an_approaching_obstacle_raises_the_bound_and_a_receding_one_lowers_it(void**) {
  Random random(3);
  for (int trial = 0; trial < 500; ++trial) {
    const JointVector q_rad = random.configuration(lwa3());
    const int shape = moving_shape(random);
    Obstacle obstacle = random_obstacle(transformed(forward_kinematics(lwa3(), q_rad), shape_of(shape)), random);
    const Proximity now = measure_pair(transformed(forward_kinematics(lwa3(), q_rad), shape_of(shape)), obstacle);
    if (now.distance_m > kSettings.range_m) continue;
    double bounds[3];
    for (int sign = -1; sign <= 1; ++sign) {
      Scene scene(q_rad);
      obstacle.velocity_mps = 0.3 * sign * now.normal;
      scene.add(obstacle);
      const ConstraintRows rows = scene.rows_of(pair_of(scene.poses, shape, 0, obstacle), true);
      bounds[sign + 1] =
          rows.size() > 0 ? rows[0].bound : -std::numeric_limits<double>::infinity();  // met by every velocity
    }
    check(bounds[0] <= bounds[1] && bounds[1] <= bounds[2], "trial %d: %g, %g, %g", trial, bounds[0], bounds[1],
          bounds[2]);
  }
}

/// Of the velocities with and without the lead, the hard row has the one that approaches faster.
void a_lead_raises_the_bound_and_never_lowers_it(void**) {
  Random random(14);
  int receding = 0, approaching = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    Scene scene(random.configuration(lwa3()));
    const int shape = moving_shape(random);
    Obstacle obstacle = random_obstacle(transformed(scene.poses, shape_of(shape)), random);
    obstacle.lead_mps = random.inside(-0.5, 0.5);
    scene.add(obstacle);
    NearPair pair = pair_of(scene.poses, shape, 0, obstacle);
    const PointJacobian jacobian = point_jacobian(scene.poses, shape_of(shape).body, pair.now.on_arm);
    if (pair.now.distance_m > kSettings.range_m || !joints_matter(jacobian.transpose() * pair.now.normal)) continue;
    const double bound_mps = scene.rows_of(pair)[0].bound;
    scene.set->obstacles[0].lead_mps.setZero();
    const double with_mps = scene.rows_of(pair)[0].bound;
    pair.velocity_mps -= obstacle.lead_mps;
    const double without_mps = scene.rows_of(pair)[0].bound;
    check_near(bound_mps, std::max(with_mps, without_mps), 1e-12);
    ++(with_mps < without_mps ? receding : approaching);
  }
  check(receding > 100 && approaching > 100, "%d receding, %d approaching", receding, approaching);
}

/// The closest approach is that of the obstacle's nearest point now, which `point` represents.
void pass_rows_are_the_gradients_of_the_closest_approach(void**) {
  Random random(4);
  int seen = 0;
  for (int trial = 0; trial < 4500; ++trial) {
    Scene scene(random.configuration(lwa3()));
    const int shape = moving_shape(random);
    const Obstacle obstacle = random_obstacle(transformed(scene.poses, shape_of(shape)), random);
    scene.add(obstacle);
    const NearPair pair = pair_of(scene.poses, shape, 0, obstacle);
    if (obstacle.shape == Shape::kBox || pair.approach.head_on || pair.approach.axis_distance_m < kKink_m) continue;
    Obstacle point = sphere_obstacle(pair.now.on_obstacle, obstacle.capsule.radius_m);
    point.velocity_mps = obstacle.velocity_mps;
    const JointVector expected = gradient(scene.q_rad, [&](const LinkPoses& poses) {
      const Capsule link = transformed(poses, shape_of(shape));
      return predict_closest_approach(link, point, measure_pair(link, point), kSettings.pass_horizon_s).distance_m;
    });
    const ConstraintRows rows = scene.rows_of(pair);
    for (const ConstraintRow& row : rows) {
      if (row.tier != Tier::kPass) continue;
      check_near_because(row.row, expected, kTolerance, "trial %d, d = %g m", trial, pair.approach.distance_m);
      ++seen;
    }
  }
  check(seen > 800, "only %d", seen);
}

/// An obstacle that only turns gives the same bounds as one that translates with the velocity of that point.
void a_turning_obstacle_counts_with_the_velocity_of_its_nearest_point(void**) {
  Random random(7);
  int seen = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    const JointVector q_rad = random.configuration(lwa3());
    const int shape = moving_shape(random);
    Obstacle turning = random_obstacle(transformed(forward_kinematics(lwa3(), q_rad), shape_of(shape)), random);
    turning.velocity_mps.setZero();
    turning.angular_velocity_radps = random.inside(-2, 2);
    Scene scene(q_rad);
    scene.add(turning);
    const NearPair pair = pair_of(scene.poses, shape, 0, turning);
    Obstacle translating = turning;
    translating.velocity_mps = pair.velocity_mps;
    translating.angular_velocity_radps.setZero();
    const ConstraintRows rows = scene.rows_of(pair), same = scene.rows_of(pair_of(scene.poses, shape, 0, translating));
    assert_int_equal(rows.size(), same.size());
    for (int i = 0; i < rows.size(); ++i) check_near_because(rows[i].bound, same[i].bound, 1e-9, "trial %d", trial);
    seen += rows.size() > 0 && std::abs(pair.velocity_mps.dot(pair.now.normal)) > 0.01;
  }
  check(seen > 100, "only %d", seen);
}

/// Rotation vector of a body's motion while the arm brakes from its last velocity, by finite differences.
Vector3 turn_while_braking(const Scene& scene, int body) {
  const double braking_s = (scene.last_radps.array().abs() / lwa3().limits.acceleration_radps2.array()).maxCoeff();
  const LinkPoses after = forward_kinematics(lwa3(), scene.q_rad + 1e-6 * scene.last_radps);
  const auto index = static_cast<size_t>(body);
  const Eigen::AngleAxisd turn(Matrix3(after.rotation[index] * scene.poses.rotation[index].transpose()));
  return braking_s / 1e-6 * turn.angle() * turn.axis();
}

/// Of the ends of a link's axis at the last velocity, by a difference of two configurations.
double fastest_mps(const Scene& scene, int shape) {
  const double h_s = 1e-6;
  const LinkPoses after = forward_kinematics(lwa3(), scene.q_rad + h_s * scene.last_radps);
  const Capsule now = transformed(scene.poses, shape_of(shape)), then = transformed(after, shape_of(shape));
  return std::max((then.start - now.start).norm(), (then.end - now.end).norm()) / h_s;
}

void turning_links_have_hard_rows_for_the_next_points(void**) {
  Random random(8);
  int seen = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    Scene scene(random.configuration(lwa3()));
    const int shape = moving_shape(random), body = shape_of(shape).body;
    Obstacle obstacle = random_obstacle(transformed(scene.poses, shape_of(shape)), random);
    obstacle.velocity_mps.setZero();
    scene.add(obstacle);
    const NearPair pair = pair_of(scene.poses, shape, 0, obstacle);
    if (pair.now.distance_m > kSettings.range_m) continue;
    const int without = scene.rows_of(pair, true).size();
    scene.last_radps = random.joints(7, -1.5, 1.5);
    const ConstraintRows rows = scene.rows_of(pair, true);
    if (obstacle.capsule.is_sphere()) {
      assert_int_equal(rows.size(), without);
      continue;
    }
    const double clearance_m =
        kSettings.rest_clearance_m + std::min(1.0, fastest_mps(scene, shape) / kFastLink_mps) *
                                         (kSettings.hard_clearance_m - kSettings.rest_clearance_m);
    const PosedShape link{shape_of(shape), scene.poses, scene.clearance.links[shape]};
    for (const Proximity& next : proximities_after_turn(link, obstacle, pair.now, turn_while_braking(scene, body))) {
      if (next.distance_m > kSettings.range_m) continue;
      const JointVector expected = point_jacobian(scene.poses, body, next.on_arm).transpose() * next.normal;
      if (!joints_matter(expected)) continue;
      const double bound = hard_bound(expected, next.distance_m - clearance_m);
      const bool found = std::any_of(rows.begin(), rows.end(), [&](const ConstraintRow& row) {
        return (row.row - expected).norm() < 1e-4 && std::abs(row.bound - bound) < 1e-4;
      });
      check(found, "trial %d", trial);
      ++seen;
    }
  }
  check(seen > 300, "only %d", seen);
}

void rows_of_self_pairs_are_512_times_the_gradients_of_their_distances(void**) {
  const double weight = 512.0;
  const std::vector<SelfPair> pairs = find_self_pairs(lwa3(), 0.02).kept;
  Random random(5);
  int seen = 0;
  for (int trial = 0; trial < 500; ++trial) {
    Scene scene(random.configuration(lwa3()));
    for (const auto& [a, b, clearance_m] : pairs) {
      const auto distance = [a = a, b = b](const LinkPoses& poses) {
        return measure_pair(transformed(poses, shape_of(a)), transformed(poses, shape_of(b)));
      };
      const Proximity now = distance(scene.poses);
      if (now.axis_distance_m < kKink_m) continue;
      scene.self_pairs = {{a, b, clearance_m}};
      const ConstraintRows rows = scene.rows(range_of(1e9));
      const JointVector expected =
          gradient(scene.q_rad, [&](const LinkPoses& poses) { return distance(poses).distance_m; });
      if (!joints_matter(expected)) continue;
      assert_int_equal(rows.size(), 1);
      const JointVector row = rows[0].row / weight;
      check_near_because(row, expected, kTolerance, "trial %d, links %d and %d", trial, a, b);
      const double room_m = now.distance_m >= clearance_m         ? now.distance_m - clearance_m
                            : now.distance_m >= clearance_m / 2.0 ? 0.0
                                                                  : now.distance_m - clearance_m / 2.0;
      check_near(rows[0].bound, weight * hard_bound(row, room_m), 1e-9);
      ++seen;
    }
  }
  check(seen > 600, "only %d", seen);
}

void the_links_with_the_least_room_are_reported_and_limit_what_brings_them_together(void**) {
  const std::vector<SelfPair> pairs = find_self_pairs(lwa3(), 0.02).kept;
  Random random(9);
  int limited = 0;
  for (int trial = 0; trial < 500; ++trial) {
    Scene scene(random.configuration(lwa3()));
    scene.self_pairs = pairs;
    scene.nominal_radps = random.joints(7, -30, 30);
    const RowSets rows = scene.row_sets(range_of(1e9), range_of(1e9));
    double least_room_m = std::numeric_limits<double>::infinity(), distance_m = 0.0;
    bool violated = false;
    for (const auto& [a, b, clearance_m] : pairs) {
      const Proximity now = measure_pair(transformed(scene.poses, shape_of(a)), transformed(scene.poses, shape_of(b)));
      if (now.distance_m - clearance_m < least_room_m)
        least_room_m = now.distance_m - clearance_m, distance_m = now.distance_m;
    }
    for (const ConstraintRow& row : rows.plan) violated |= row.row.dot(scene.nominal_radps) < row.bound - 1e-4;
    check_near(rows.nearest_links.distance_m, distance_m, 1e-12);
    assert_true(rows.nearest_links.first >= 0 && rows.nearest_links.second >= 0);
    assert_int_equal(rows.links_limit, violated);
    limited += violated;
  }
  check(limited > 20 && limited < 480, "%d of 500", limited);
  const RowSets none = Scene(JointVector::Zero(7)).row_sets(range_of(1), range_of(1));
  assert_true(std::isnan(none.nearest_links.distance_m) && none.nearest_links.first == -1 && !none.links_limit);
}

double worst_shortfall(const ConstraintRow& row, const VelocityRange& range) {
  double worst = row.bound;
  for (int i = 0; i < 7; ++i) worst -= row.row[i] * (row.row[i] > 0.0 ? range.lower_radps[i] : range.upper_radps[i]);
  return worst;
}

bool same(const ConstraintRow& a, const ConstraintRow& b) {
  return a.row == b.row && a.bound == b.bound && a.tier == b.tier && a.other_bound == b.other_bound;
}

/// All rows of all pairs, without the limit on their number. Rows of separation depend on the range: of these, those
/// that some velocity in it does not meet.
std::vector<ConstraintRow> all_rows(Scene& scene, const std::vector<NearPair>& near, const VelocityRange& range) {
  std::vector<ConstraintRow> all;
  for (const NearPair& pair : near) {
    const Obstacle& obstacle = scene.set->obstacles[static_cast<size_t>(pair.now.obstacle)];
    const bool separates = obstacle.kind == Kind::kPerson && scene.person_weight > 0.0;
    for (const ConstraintRow& row : scene.rows_of(pair))
      if (!separates || row.tier != Tier::kComfort) all.push_back(row);
    if (!separates) continue;
    for (const ConstraintRow& row : scene.rows(range))  // of the same pair, which rows_of() has set
      if (row.tier == Tier::kComfort) all.push_back(row);
  }
  return all;
}

/// Whether it is the row of a near person that only keeps the arm from approaching.
bool is_against_approach(const ConstraintRow& row, const std::vector<ConstraintRow>& all) {
  return std::any_of(all.begin(), all.end(), [&](const ConstraintRow& one) {
    return one.tier == Tier::kHard && row.tier == Tier::kHard && row.row == 64.0 * one.row;
  });
}

/// Places that are reserved for each tier.
using Places = std::array<size_t, kTiers>;
constexpr Places kBesidePersons{24, 16, 16}, kNoneReserved{};

/// Checks that the rows kept are those that some velocity in the range does not meet; of too many, of each tier the
/// most urgent. Returns whether they are too many.
bool check_kept(const std::vector<ConstraintRow>& all, const ConstraintRows& kept, const VelocityRange& range,
                const Places& reserved, int trial) {
  const auto violation = [&](const ConstraintRow& row) {
    return worst_shortfall(row, range) / (is_against_approach(row, all) ? 64.0 : 1.0);
  };
  std::array<std::vector<ConstraintRow>, kTiers> relevant;
  for (const ConstraintRow& row : all)
    if (worst_shortfall(row, range) > 0.0) relevant[static_cast<size_t>(row.tier)].push_back(row);
  size_t count = 0, room = kMaxRows;
  for (size_t tier = 0; tier < kTiers; ++tier) {
    count += relevant[tier].size();
    room -= std::min(reserved[tier], relevant[tier].size());
  }
  assert_int_equal(kept.size(), std::min<size_t>(kMaxRows, count));
  for (size_t tier = 0; tier < kTiers; ++tier) {
    std::vector<ConstraintRow>& rows = relevant[tier];
    const size_t more = rows.size() - std::min(reserved[tier], rows.size()), granted = std::min(more, room);
    room -= granted;
    const size_t keeps = rows.size() - more + granted;
    std::sort(rows.begin(), rows.end(),
              [&](const ConstraintRow& a, const ConstraintRow& b) { return violation(a) > violation(b); });
    const auto is_of_tier = [&](const ConstraintRow& row) { return static_cast<size_t>(row.tier) == tier; };
    check(std::count_if(kept.begin(), kept.end(), is_of_tier) == static_cast<long>(keeps),
          "trial %d, tier %zu: not %zu", trial, tier, keeps);
    for (const ConstraintRow& row : kept)
      if (is_of_tier(row))
        check(violation(row) > violation(rows[keeps - 1]) - 1e-12, "trial %d, tier %zu: kept %g, the last of %zu is %g",
              trial, tier, violation(row), keeps, violation(rows[keeps - 1]));
    const auto is_kept = [&](const ConstraintRow& one) {
      return std::any_of(kept.begin(), kept.end(), [&](const ConstraintRow& row) { return same(one, row); });
    };
    for (size_t i = 0; i < keeps; ++i)
      check(is_kept(rows[i]) || violation(rows[i]) < violation(rows[keeps - 1]) + 1e-12,
            "trial %d, tier %zu: skipped %g", trial, tier, violation(rows[i]));
  }
  return count > kMaxRows;
}

void only_rows_that_every_velocity_meets_and_the_least_urgent_are_skipped(void**) {
  Random random(6);
  int crowded[2] = {};
  for (int trial = 0; trial < 300; ++trial) {
    Scene scene(random.configuration(lwa3()));
    scene.last_radps = random.joints(7, -2, 2);
    const bool persons = random.chance(0.5);
    scene.person_weight = persons ? 100.0 : 0.0;
    std::vector<NearPair> near;
    bool has_person = false;
    for (int i = random.index(kMaxNear + 1); i > 0; --i) {
      const int shape = moving_shape(random);
      Obstacle obstacle = random_obstacle(transformed(scene.poses, shape_of(shape)), random);
      if (persons && random.chance(0.8)) obstacle.kind = Kind::kPerson;
      has_person |= obstacle.kind == Kind::kPerson;
      scene.add(obstacle);
      near.push_back(pair_of(scene.poses, shape, scene.set->count - 1, obstacle));
    }
    // The range of the step may lie partly outside the sustainable range: a joint may be too fast for its limit.
    const VelocityRange sustainable = random_range(random, 2.0),
                        within{0.5 * sustainable.lower_radps + 0.5 * sustainable.upper_radps, sustainable.upper_radps};
    const VelocityRange range = random.chance(0.5) ? within : random_range(random, 2.0);
    const std::vector<ConstraintRow> all = all_rows(scene, near, sustainable);
    std::vector<ConstraintRow> hard;
    std::copy_if(all.begin(), all.end(), std::back_inserter(hard),
                 [](const ConstraintRow& row) { return row.tier == Tier::kHard; });
    scene.clearance.near.clear();
    for (const NearPair& pair : near) scene.clearance.near.add(pair);
    const RowSets rows = scene.row_sets(sustainable, range);
    crowded[has_person] += check_kept(all, rows.plan, sustainable, has_person ? kBesidePersons : kNoneReserved, trial);
    for (ConstraintRow& row : hard)
      if (is_against_approach(row, hard)) row.bound = std::min(row.bound, most_mps(row.row, range));
    check_kept(hard, rows.step, range, kNoneReserved, trial);
  }
  check(crowded[0] > 20 && crowded[1] > 20, "only %d, %d beside persons", crowded[0], crowded[1]);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(distance_rows_are_the_gradients_of_the_distances),
      cmocka_unit_test(the_bounds_of_distance_rows_are_barriers),
      cmocka_unit_test(a_command_ahead_of_the_arm_takes_room_from_what_it_approaches),
      cmocka_unit_test(a_person_has_a_row_of_separation),
      cmocka_unit_test(a_near_person_has_a_row_against_the_approach_of_the_arm_itself),
      cmocka_unit_test(an_approaching_obstacle_raises_the_bound_and_a_receding_one_lowers_it),
      cmocka_unit_test(a_lead_raises_the_bound_and_never_lowers_it),
      cmocka_unit_test(pass_rows_are_the_gradients_of_the_closest_approach),
      cmocka_unit_test(a_turning_obstacle_counts_with_the_velocity_of_its_nearest_point),
      cmocka_unit_test(turning_links_have_hard_rows_for_the_next_points),
      cmocka_unit_test(rows_of_self_pairs_are_512_times_the_gradients_of_their_distances),
      cmocka_unit_test(the_links_with_the_least_room_are_reported_and_limit_what_brings_them_together),
      cmocka_unit_test(only_rows_that_every_velocity_meets_and_the_least_urgent_are_skipped),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
