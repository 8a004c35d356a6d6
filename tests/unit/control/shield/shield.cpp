#include "firmware/control/shield/shield.h"

#include <cstdlib>
#include <ctime>

#include "firmware/control/shield/constraint_rows.h"
#include "tests/support/check.h"
#include "tests/support/closed_loop.h"
#include "tests/support/lwa3.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::lwa3_model;
using test::Random;

namespace {

constexpr double kPeriod_s = 0.01;

const Model& model() {
  static const Model lwa3 = lwa3_model("sidestep");
  return lwa3;
}

/// Number of random states: 20 000, or the environment variable SHIELD_STATES.
long states() {
  const char* text = std::getenv("SHIELD_STATES");
  return text ? std::atol(text) : 20000;
}

/// The inputs of one call of the shield.
struct Scene {
  JointVector q_rad = JointVector::Zero(7), last_radps = JointVector::Zero(7), nominal_radps = JointVector::Zero(7);
  ObstacleSet& set;  // large
  double comfort_weight = 300.0;
  int task_rows = 3;
  double step_tool_weight = 0.0, person_weight = 0.0;
  LinkPoses poses{};
  ObstacleView view{};
  Clearance clearance{};
  VelocityRange sustainable{}, range{};
  JointVector evasion_radps{};

  void measure() {
    const ShieldSettings& settings = model().settings.shield;
    poses = forward_kinematics(model().arm, q_rad);
    view.set = &set;
    clearance = measure_clearance(model().arm, poses, view, {settings.range_m, settings.pass_horizon_s});
    sustainable = sustainable_range(model().arm.limits, q_rad, q_rad, kPeriod_s);
    range = velocity_range(model().arm.limits, q_rad, q_rad, last_radps, kPeriod_s);
  }
  ShieldInput input() const {
    ShieldInput input = {model().arm,   poses,     q_rad,          q_rad,
                         last_radps,    clearance, view,           model().self_pairs,
                         evasion_radps, kPeriod_s, comfort_weight, model().settings.shield.tool_weight};
    input.step_tool_weight = step_tool_weight;
    input.person_weight = person_weight;
    return input;
  }
  ShieldResult shielded() const {
    return shield(model().settings.shield, input(), sustainable, range, tool_jacobian(poses, task_rows), nominal_radps);
  }
  RowSets rows() const { return make_rows(model().settings.shield, input(), sustainable, range, JointVector::Zero(7)); }
  ConstraintRows hard_rows() const { return rows().step; }

  void add(const Capsule& capsule, const Vector3& velocity_mps = Vector3::Zero()) {
    set.obstacles[static_cast<size_t>(set.count)] = {set.count, Shape::kCapsule, capsule, velocity_mps,
                                                     Vector3::Zero()};
    ++set.count;
  }
  /// One period: the arm moves at the shield's velocity, the obstacles at theirs.
  ShieldResult cycle() {
    measure();
    const ShieldResult given = shielded();
    q_rad += kPeriod_s * given.velocity_radps;
    last_radps = given.velocity_radps;
    evasion_radps = given.plan.evading ? given.plan.velocity_radps : JointVector();
    for (int i = 0; i < set.count; ++i) {
      Obstacle& obstacle = set.obstacles[static_cast<size_t>(i)];
      obstacle = extrapolated(obstacle, kPeriod_s);
    }
    return given;
  }
  /// Least distance of the links that can move.
  double distance_m() {
    measure();
    double least_m = std::numeric_limits<double>::infinity();
    for (const NearPair& pair : clearance.near) least_m = std::min(least_m, pair.now.distance_m);
    return least_m;
  }
};

ObstacleSet& empty_set() {
  static ObstacleSet set;
  set.count = 0;
  return set;
}

/// A point on the axis of a link that moves.
Vector3 on_the_arm(const LinkPoses& poses, Random& random) {
  const std::vector<LinkShape>& shapes = model().arm.shapes;
  const LinkShape* shape = &shapes[0];
  while (shape->body == 0) shape = &shapes[static_cast<size_t>(random.index(static_cast<int>(shapes.size())))];
  const Capsule link = transformed(poses, *shape);
  return link.start + random.uniform(0, 1) * (link.end - link.start);
}

JointVector extreme_configuration(Random& random) {
  const JointLimits& limits = model().arm.limits;
  JointVector q_rad = random.configuration(model().arm);
  if (random.chance(0.1)) q_rad = test::home_rad();
  if (random.chance(0.1)) q_rad.setZero();  // stretched
  for (int i = 0; i < 7; ++i) {
    if (random.chance(0.05)) q_rad[i] = random.chance(0.5) ? limits.lower_rad[i] : limits.upper_rad[i];
    if (random.chance(0.02)) q_rad[i] = limits.upper_rad[i] + random.uniform(0, 0.3);
    if (random.chance(0.02)) q_rad[i] = limits.lower_rad[i] - random.uniform(0, 0.3);
  }
  return q_rad;
}

/// Places a few obstacles most of the time and up to 64 sometimes, from deep inside the arm to out of its reach.
void surround(Scene& scene, const LinkPoses& poses, Random& random) {
  scene.set.count = 0;
  const int count = random.chance(0.02) ? random.index(65) : random.index(3);
  for (int i = 0; i < count; ++i) {
    const Vector3 away = random.direction() * (random.chance(0.02) ? 0.0 : random.uniform(0, 0.5));
    const Vector3 centre = on_the_arm(poses, random) + away;
    const Vector3 half = random.chance(0.3) ? random.inside(-0.2, 0.2) : Vector3(Vector3::Zero());
    const double speed_mps = random.chance(0.5) ? 0.0 : std::pow(10.0, random.uniform(-2, 1));
    const Vector3 to_arm = away.norm() > 0 && random.chance(0.5) ? Vector3(-away.normalized()) : random.direction();
    scene.add({centre - half, centre + half, random.chance(0.05) ? 0.0 : random.uniform(0, 0.2)}, to_arm * speed_mps);
    if (random.chance(0.2)) scene.set.obstacles[static_cast<size_t>(i)].angular_velocity_radps = random.inside(-3, 3);
  }
}

void randomise(Scene& scene, Random& random) {
  scene.q_rad = extreme_configuration(random);
  surround(scene, forward_kinematics(model().arm, scene.q_rad), random);
  scene.last_radps = random.joints(7, -2, 2) * (random.chance(0.3) ? 0.0 : 1.0);
  scene.nominal_radps = random.joints(7, -1, 1) * std::pow(10.0, random.uniform(-2, 3));
  if (random.chance(0.1)) scene.nominal_radps.setZero();
  scene.evasion_radps = random.chance(0.5) ? random.joints(7, -2, 2) : JointVector();
  scene.comfort_weight = random.chance(0.5) ? 300.0 : 1.0;
  scene.task_rows = random.chance(0.5) ? 3 : 6;
  scene.step_tool_weight = random.chance(0.5) ? model().settings.shield.tool_weight : 0.0;
  scene.view = {&scene.set, random.uniform(0, 0.1), random.chance(0.1) ? random.uniform(0, 0.5) : 0.0};
  scene.measure();
}

bool within(const VelocityRange& range, const JointVector& velocity_radps) {
  return velocity_radps.allFinite() && (velocity_radps.array() >= range.lower_radps.array()).all() &&
         (velocity_radps.array() <= range.upper_radps.array()).all();
}

/// Shortfall of a velocity in the worst hard row, m/s; 0 when it meets all rows.
double worst_shortfall(const ConstraintRows& rows, const JointVector& velocity_radps, int* which = nullptr) {
  double worst = 0.0;
  for (int i = 0; i < rows.size(); ++i) {
    const ConstraintRow& row = rows[i];
    const double shortfall = row.bound - row.row.dot(velocity_radps);
    if (shortfall <= worst) continue;
    worst = shortfall;
    if (which) *which = i;
  }
  return worst;
}

/// Least such shortfall found by a search: the corners of the range, random velocities, then steps along the worst row.
double least_shortfall(const ConstraintRows& rows, const VelocityRange& range, Random& random) {
  const JointVector span = range.upper_radps - range.lower_radps;
  JointVector best_radps = range.lower_radps;
  double best = worst_shortfall(rows, best_radps);
  const auto consider = [&](const JointVector& velocity_radps) {
    const double shortfall = worst_shortfall(rows, velocity_radps);
    if (shortfall >= best) return;
    best = shortfall;
    best_radps = velocity_radps;
  };
  for (int corner = 0; corner < 128; ++corner) {
    JointVector velocity_radps = range.lower_radps;
    for (int i = 0; i < 7; ++i)
      if (corner >> i & 1) velocity_radps[i] += span[i];
    consider(velocity_radps);
  }
  for (int i = 0; i < 200; ++i) consider(range.lower_radps + span.cwiseProduct(random.joints(7, 0, 1)));
  JointVector velocity_radps = best_radps;
  for (int i = 0; i < 300; ++i) {
    int worst = -1;
    worst_shortfall(rows, velocity_radps, &worst);
    if (worst < 0) return 0.0;
    const JointVector& row = rows[worst].row;
    const double step = span.norm() / (1.0 + i);
    velocity_radps += row * (step / std::max(1e-9, row.norm()));
    velocity_radps = velocity_radps.cwiseMax(range.lower_radps).cwiseMin(range.upper_radps);
    consider(velocity_radps);
  }
  return best;
}

// Shortfall that the hard tier may have in favour of the nominal velocity: its weight is large, not infinite.
constexpr double kShortfall_mps = 5e-3;

void check_least_slack(const Scene& scene, const ShieldResult& given, Random& random, long trial) {
  const ConstraintRows rows = scene.hard_rows();
  const double shortfall_mps = worst_shortfall(rows, given.velocity_radps);
  check(shortfall_mps <= given.hard_slack_mps + kShortfall_mps, "state %ld: shortfall %g m/s, %g reported", trial,
        shortfall_mps, given.hard_slack_mps);
  const double least_mps = least_shortfall(rows, scene.range, random);
  check(shortfall_mps <= least_mps + kShortfall_mps, "state %ld: shortfall %g m/s where %g is possible", trial,
        shortfall_mps, least_mps);
}

/// CPU time of one call. A long one is repeated, since other load on the machine may have caused it.
double cpu_time_s(const Scene& scene, ShieldResult& given) {
  double least_s = std::numeric_limits<double>::infinity();
  for (int attempt = 0; attempt < 3 && least_s > 0.2 * kPeriod_s; ++attempt) {
    const std::clock_t start = std::clock();
    given = scene.shielded();
    least_s = std::min(least_s, static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  }
  return least_s;
}

void in_any_state_the_velocity_is_within_range_and_computed_within_a_period(void**) {
  Random random(1);
  Scene scene{{}, {}, {}, empty_set()};
  double longest_s = 0.0, sum_s = 0.0;
  for (long trial = 0; trial < states(); ++trial) {
    randomise(scene, random);
    // In every other state all obstacles are persons.
    scene.person_weight = trial % 2 == 0 ? 0.0 : model().settings.shield.person_weight;
    for (int i = 0; trial % 2 != 0 && i < scene.set.count; ++i)
      scene.set.obstacles[static_cast<size_t>(i)].kind = Kind::kPerson;
    ShieldResult given;
    const double took_s = cpu_time_s(scene, given);
    longest_s = std::max(longest_s, took_s);
    sum_s += took_s;
    check(within(scene.range, given.velocity_radps), "state %ld: %g rad/s", trial,
          given.velocity_radps.cwiseAbs().maxCoeff());
    check(std::isfinite(given.hard_slack_mps) && given.hard_slack_mps >= 0.0, "state %ld: slack %g", trial,
          given.hard_slack_mps);
  }
  print_message("shield: %.1f us in the mean, %.1f us at most (CPU)\n", 1e6 * sum_s / static_cast<double>(states()),
                1e6 * longest_s);
  const bool untimed = std::getenv("UNTIMED") != nullptr;  // for builds whose CPU times are meaningless
  check(untimed || longest_s < kPeriod_s, "%g s", longest_s);
}

void the_worst_hard_row_has_the_least_possible_slack(void**) {
  Random random(2);
  Scene scene{{}, {}, {}, empty_set()};
  int has_slack = 0;
  for (long trial = 0; trial < states() / 40; ++trial) {
    randomise(scene, random);
    const ShieldResult given = scene.shielded();
    check(!given.failed, "state %ld: the solver failed", trial);
    check_least_slack(scene, given, random, trial);
    if (given.hard_slack_mps > 0.01) ++has_slack;
  }
  check(has_slack > states() / 400, "only %d states with slack", has_slack);
}

void without_obstacles_a_nominal_velocity_within_range_is_unchanged(void**) {
  Random random(3);
  Scene scene{{}, {}, {}, empty_set()};
  int unchanged = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    randomise(scene, random);
    scene.set.count = 0;
    scene.measure();
    if (scene.hard_rows().size() > 0) continue;  // two links are close to each other
    for (int i = 0; i < 7; ++i)
      scene.nominal_radps[i] = random.uniform(std::max(scene.sustainable.lower_radps[i], scene.range.lower_radps[i]),
                                              std::min(scene.sustainable.upper_radps[i], scene.range.upper_radps[i]));
    if (!within(scene.range, scene.nominal_radps) || !within(scene.sustainable, scene.nominal_radps)) continue;
    const ConstraintRows rows =
        make_rows(model().settings.shield, scene.input(), scene.sustainable, scene.sustainable, JointVector::Zero(7))
            .step;
    if (worst_shortfall(rows, scene.nominal_radps) > 0.0) continue;
    const ShieldResult given = scene.shielded();
    check_near_because(given.velocity_radps, scene.nominal_radps, 0.0, "state %d", trial);
    check_near(given.hard_slack_mps, 0.0, 0.0);
    ++unchanged;
  }
  check(unchanged > 300, "only %d", unchanged);
}

/// How far a velocity is from the plan: of the joints, and of the tool with its weight.
double deviation(const Scene& scene, const JointVector& plan_radps, const JointVector& velocity_radps) {
  const JointVector change = velocity_radps - plan_radps;
  const double tool = (tool_jacobian(scene.poses, scene.task_rows) * change).squaredNorm();
  return change.squaredNorm() + scene.step_tool_weight * tool;
}

/// Where the acceleration limits keep joints from the plan, the velocity is the nearest to it, the tool's included:
/// none of many others within the range is nearer. Without that weight it is the plan, joint by joint within the range.
void joints_make_up_for_those_that_reach_their_acceleration_limits(void**) {
  Random random(14);
  Scene scene{{}, {}, {}, empty_set()};
  int improved = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    randomise(scene, random);
    scene.set.count = 0;
    scene.nominal_radps = random.joints(7, -1, 1);
    scene.measure();
    if (scene.hard_rows().size() > 0) continue;
    const ShieldResult given = scene.shielded();
    const JointVector& plan_radps = given.plan.velocity_radps;
    const JointVector clipped_radps = plan_radps.cwiseMax(scene.range.lower_radps).cwiseMin(scene.range.upper_radps);
    if (scene.step_tool_weight == 0.0) {
      check_near_because(given.velocity_radps, clipped_radps, 1e-9, "state %d", trial);
      continue;
    }
    const double given_deviation = deviation(scene, plan_radps, given.velocity_radps);
    improved += given_deviation < 0.9 * deviation(scene, plan_radps, clipped_radps);
    for (int i = 0; i < 100; ++i) {
      const double step_radps = std::pow(10.0, random.uniform(-4, 0));
      const JointVector near_radps = given.velocity_radps + random.joints(7, -step_radps, step_radps);
      const JointVector other_radps = near_radps.cwiseMax(scene.range.lower_radps).cwiseMin(scene.range.upper_radps);
      check(given_deviation <= deviation(scene, plan_radps, other_radps) + 1e-9, "state %d", trial);
    }
  }
  check(improved > 100, "only %d", improved);
}

/// With hard rows, where evasion replaced the plan, and where an obstacle that shall be passed comes fast or is near,
/// the tool's weight changes nothing. Elsewhere it does.
void the_tool_of_the_coming_period_counts_less_than_clearance(void**) {
  Random random(15);
  Scene scene{{}, {}, {}, empty_set()};
  int with_rows = 0, evading = 0, urgent = 0, changed = 0;
  for (int trial = 0; trial < 15000; ++trial) {
    randomise(scene, random);
    scene.step_tool_weight = 0.0;
    const ShieldResult without = scene.shielded();
    scene.step_tool_weight = model().settings.shield.tool_weight;
    const ShieldResult with = scene.shielded();
    const RowSets rows = scene.rows();
    const bool has_rows = rows.step.size() > 0, is_urgent = largest_pass_mps(rows.plan) > 0.5;
    if (has_rows || without.plan.evading || is_urgent)
      check_near_because(with.velocity_radps, without.velocity_radps, 0.0, "state %d", trial);
    else
      changed += !with.velocity_radps.isApprox(without.velocity_radps);
    with_rows += has_rows;
    evading += !has_rows && without.plan.evading;
    urgent += !has_rows && !without.plan.evading && is_urgent;
  }
  check(with_rows > 500 && evading > 10 && urgent > 10 && changed > 100, "only %d, %d, %d, %d", with_rows, evading,
        urgent, changed);
}

/// Gradient of a link's distance to the first obstacle by the joints, m/rad.
JointVector distance_gradient(const Scene& scene, int shape) {
  const LinkShape& link = model().arm.shapes[static_cast<size_t>(shape)];
  const Proximity pair = measure_pair(transformed(scene.poses, link), scene.set.obstacles[0].capsule);
  return point_jacobian(scene.poses, link.body, pair.on_arm).transpose() * pair.normal;
}

/// The nominal velocity that moves a link toward the first obstacle as fast as possible.
JointVector toward_the_obstacle(const Scene& scene, int shape) {
  const JointVector row = distance_gradient(scene, shape);
  return -row * (2.0 / std::max(1e-6, row.cwiseAbs().maxCoeff()));
}

int moving_shape(Random& random) {
  const std::vector<LinkShape>& shapes = model().arm.shapes;
  int shape = 0;
  while (shapes[static_cast<size_t>(shape)].body == 0) shape = random.index(static_cast<int>(shapes.size()));
  return shape;
}

void an_arm_driven_toward_a_static_obstacle_stops_before_it(void**) {
  const double clearance_m = model().settings.shield.rest_clearance_m;
  Random random(4);
  int stopped = 0;
  for (int trial = 0; trial < 300; ++trial) {
    Scene scene{random.configuration(model().arm, 0.9), JointVector::Zero(7), JointVector::Zero(7), empty_set()};
    scene.measure();
    const Vector3 centre = on_the_arm(scene.poses, random) + random.direction() * random.uniform(0.2, 0.5);
    const Vector3 half = trial % 3 ? Vector3(Vector3::Zero()) : random.inside(-0.2, 0.2);
    scene.add({centre - half, centre + half, random.uniform(0.02, 0.1)});
    if (scene.distance_m() < 0.08) continue;
    const int shape = moving_shape(random);
    scene.comfort_weight = model().settings.shield.comfort_least_weight;
    double least_m = 1.0;
    for (int cycle = 0; cycle < 500; ++cycle) {
      scene.nominal_radps = toward_the_obstacle(scene, shape);
      scene.cycle();
      least_m = std::min(least_m, scene.distance_m());
      check(least_m >= clearance_m - 1e-3, "trial %d, cycle %d: %g m", trial, cycle, least_m);
    }
    if (least_m < 2.0 * clearance_m) ++stopped;
  }
  check(stopped >= 60, "only %d came near", stopped);
}

void in_contact_the_distance_only_grows(void**) {
  Random random(5);
  int freed = 0, trials = 0;
  for (int trial = 0; trial < 40; ++trial) {
    Scene scene{random.configuration(model().arm, 0.9), JointVector::Zero(7), JointVector::Zero(7), empty_set()};
    scene.measure();
    const Vector3 centre = on_the_arm(scene.poses, random) + random.direction() * random.uniform(0.02, 0.1);
    scene.add({centre, centre, random.uniform(0.02, 0.1)});
    double distance_m = scene.distance_m();
    if (distance_m > 0.0) continue;
    ++trials;
    const int shape = moving_shape(random);
    for (int cycle = 0; cycle < 200; ++cycle) {
      scene.nominal_radps = toward_the_obstacle(scene, shape);
      scene.cycle();
      const double before_m = distance_m;
      distance_m = scene.distance_m();
      // Near the clearance to what rests the distance may shrink again.
      const double at_rest_m = model().settings.shield.rest_clearance_m - 1e-3;
      // A link next to the shoulder hardly moves and cannot get out of contact.
      if (distance_gradient(scene, scene.clearance.nearest.shape).norm() < 0.02) break;
      check(distance_m >= std::min(before_m, at_rest_m) - 1e-4, "trial %d, cycle %d: from %g to %g m", trial, cycle,
            before_m, distance_m);
    }
    if (distance_m > 0.0) ++freed;
  }
  check(trials >= 20 && freed >= 0.8 * trials, "%d of %d", freed, trials);
}

/// One sphere moves toward a link, and another one rests on its other side.
void between_two_obstacles_the_slack_is_the_least_possible(void**) {
  Random random(6);
  int with_slack = 0;
  for (int trial = 0; trial < 20; ++trial) {
    Scene scene{random.configuration(model().arm, 0.9), JointVector::Zero(7), JointVector::Zero(7), empty_set()};
    scene.measure();
    const Vector3 middle = on_the_arm(scene.poses, random), side = random.direction();
    const double radius_m = random.uniform(0.03, 0.1), speed_mps = random.uniform(0.1, 0.5);
    const Vector3 wall = middle - side * (radius_m + 0.08), start = middle + side * (radius_m + 0.15);
    scene.add({wall, wall, radius_m});
    scene.add({start, start, radius_m}, -side * speed_mps);
    bool has_slack = false;
    for (int cycle = 0; cycle < 100; ++cycle) {
      scene.nominal_radps = random.joints(7, -1, 1);
      const ShieldResult given = scene.cycle();
      has_slack = has_slack || given.hard_slack_mps > 0.01;
      if (cycle % 5) continue;
      scene.measure();
      check_least_slack(scene, scene.shielded(), random, trial * 1000 + cycle);
    }
    if (has_slack) ++with_slack;
  }
  check(with_slack > 5, "only %d", with_slack);
}

/// A state from which the joints can stop within their limits, with the arm close to the commanded position.
State reachable_state(Random& random, const JointVector& measured_rad, double now_s) {
  State state;
  state.supervision = {random.chance(0.8) ? Mode::kTrack : Mode::kHold, Fault::kNone, ""};
  state.stream.running = true;
  state.stream.position_rad = measured_rad;
  if (random.chance(0.3)) state.stream.position_rad += random.joints(7, -0.02, 0.02);
  const VelocityRange sustainable =
      sustainable_range(model().arm.limits, state.stream.position_rad.cwiseMin(measured_rad),
                        state.stream.position_rad.cwiseMax(measured_rad), kPeriod_s);
  state.stream.velocity_radps =
      random.joints(7, -2, 2).cwiseMax(sustainable.lower_radps).cwiseMin(sustainable.upper_radps);
  state.stream.rate_radps = state.stream.velocity_radps;
  state.arm_monitor.count = 1;
  state.arm_monitor.received_s = now_s;
  state.arm_monitor.before = state.arm_monitor.accepted = {{1, measured_rad, JointVector::Zero(7)}, now_s};
  state.arm_monitor.cycle_s = now_s - kPeriod_s;
  return state;
}

/// How much faster than the barrier of 15 1/s above 20 mm permits the arm comes nearer to a sphere at rest 12 mm beside
/// it, m/s at most, while another one comes from the opposite side at 3 m/s.
double too_fast_by_mps(const JointVector& q_rad, const Vector3& on_axis_m, const Vector3& away, double radius_m,
                       Kind kind) {
  Scene scene{q_rad, JointVector::Zero(7), JointVector::Zero(7), empty_set()};
  const double sphere_m = 0.05, beside_m = radius_m + sphere_m + 0.012;
  const Vector3 resting_m = on_axis_m + beside_m * away, coming_m = on_axis_m - (beside_m + 0.4) * away;
  scene.add({resting_m, resting_m, sphere_m});
  scene.add({coming_m, coming_m, sphere_m}, 3.0 * away);
  for (int i = 0; i < 2; ++i) scene.set.obstacles[static_cast<size_t>(i)].kind = kind;
  const auto to_resting_m = [&] {
    scene.measure();
    double least_m = std::numeric_limits<double>::infinity();
    for (const NearPair& pair : scene.clearance.near)
      if (pair.now.obstacle == 0) least_m = std::min(least_m, pair.now.distance_m);
    return least_m;
  };
  double largest_mps = 0.0, before_m = to_resting_m();
  for (int cycle = 0; cycle < 14; ++cycle) {
    scene.cycle();
    const double now_m = to_resting_m();
    const double permitted_mps = 15.0 * std::max(0.0, before_m - 0.02);
    largest_mps = std::max(largest_mps, (before_m - now_m) / kPeriod_s - permitted_mps);
    before_m = now_m;
  }
  return largest_mps;
}

void an_arm_does_not_evade_one_limb_of_a_person_into_another(void**) {
  Random random(21);
  int things = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const JointVector q_rad = random.configuration(model().arm, 0.7);
    const LinkPoses poses = forward_kinematics(model().arm, q_rad);
    const LinkShape& shape = model().arm.shapes.back();
    const Capsule link = transformed(poses, shape);
    const Vector3 on_axis_m = 0.5 * (link.start + link.end);
    const Vector3 away = (link.end - link.start).cross(random.direction()).normalized();
    const double person_mps = too_fast_by_mps(q_rad, on_axis_m, away, link.radius_m, Kind::kPerson);
    check(person_mps < 0.05, "trial %d: %g m/s", trial, person_mps);
    things += too_fast_by_mps(q_rad, on_axis_m, away, link.radius_m, Kind::kThing) > 0.1;
  }
  check(things > 50, "only %d things are approached", things);
}

Target random_target(Random& random) {
  Target target;
  target.position_m = random.inside(-1, 1) + Vector3(0, 0, 0.6);
  target.velocity_mps = random.inside(-1, 1) * (random.chance(0.5) ? 0.0 : std::pow(10.0, random.uniform(-2, 1)));
  target.tracks_orientation = random.chance(0.4);
  target.orientation = random.turn();
  target.angular_velocity_radps = random.inside(-3, 3);
  return target;
}

void in_any_state_the_arm_can_follow_the_command_of_a_cycle(void**) {
  Random random(7);
  Scene scene{{}, {}, {}, empty_set()};
  for (long trial = 0; trial < states(); ++trial) {
    randomise(scene, random);
    const double now_s = 100.0;
    const ArmState arm{1, scene.q_rad, scene.last_radps};
    const Target target = random_target(random);
    const State state = reachable_state(random, scene.q_rad, now_s);
    const double age_s = random.uniform(0, 0.09);
    const Inputs inputs{{&arm, now_s, 1}, {&target, now_s, 1}, {&scene.set, now_s - age_s, 1}, 0, false};
    const Result result = step(model(), state, inputs, now_s);
    test::CommandCheck commands(model().arm.limits, kPeriod_s);
    commands.begin(state.stream.position_rad, state.stream.velocity_radps);
    commands.feed(result.command.position_rad, result.command.velocity_radps);
    check(result.commanding && result.report.mode == Mode::kTrack, "state %ld: mode %d", trial,
          static_cast<int>(result.report.mode));
    check(commands.violation().empty(), "state %ld: %s", trial, commands.violation().c_str());
  }
}

/// With an infinite weight the programme of the plan has no finite objective. (Slow joints: the solution is at a bound
/// of the range, which leaves the programme to the general solver.)
void an_arm_whose_shield_fails_comes_to_rest(void**) {
  test::ClosedLoop loop = test::at_home("sidestep");
  loop.model.arm.limits.velocity_radps.setConstant(0.2);
  loop.commands = test::CommandCheck(loop.model.arm.limits, kPeriod_s);
  loop.sends_target = true;
  loop.run(1.0);
  check(loop.speed_radps() > 0.2, "%g rad/s", loop.speed_radps());
  assert_false(loop.last.report.limiting & kLimitingShieldFailed);
  loop.model.settings.shield.tool_weight = HUGE_VAL;
  loop.cycle();
  assert_true(loop.mode() == Mode::kTrack && (loop.last.report.limiting & kLimitingShieldFailed));
  loop.run(0.1);
  check(loop.mode() == Mode::kTrack && (loop.last.report.limiting & kLimitingShieldFailed), "%d",
        loop.last.report.limiting);
  check_near(loop.speed_radps(), 0.0, 1e-12);
  test::check_stream(loop);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(in_any_state_the_velocity_is_within_range_and_computed_within_a_period),
      cmocka_unit_test(the_worst_hard_row_has_the_least_possible_slack),
      cmocka_unit_test(without_obstacles_a_nominal_velocity_within_range_is_unchanged),
      cmocka_unit_test(joints_make_up_for_those_that_reach_their_acceleration_limits),
      cmocka_unit_test(the_tool_of_the_coming_period_counts_less_than_clearance),
      cmocka_unit_test(an_arm_driven_toward_a_static_obstacle_stops_before_it),
      cmocka_unit_test(in_contact_the_distance_only_grows),
      cmocka_unit_test(between_two_obstacles_the_slack_is_the_least_possible),
      cmocka_unit_test(an_arm_does_not_evade_one_limb_of_a_person_into_another),
      cmocka_unit_test(in_any_state_the_arm_can_follow_the_command_of_a_cycle),
      cmocka_unit_test(an_arm_whose_shield_fails_comes_to_rest),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
