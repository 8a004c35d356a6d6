#include "firmware/control/shield/evasion.h"

#include <algorithm>
#include <memory>

#include "firmware/model/prediction.h"
#include "tests/support/check.h"
#include "tests/support/closed_loop.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::Random;

namespace {

constexpr double kPeriod_s = 0.01;

const Model& model() {
  static const Model lwa3 = test::lwa3_model("sidestep");
  return lwa3;
}

/// An arm at rest, and spheres that fly at points of its links.
struct Scene {
  JointVector q_rad, rest = JointVector::Zero(7), evasion_radps;
  std::unique_ptr<ObstacleSet> set = std::make_unique<ObstacleSet>();
  LinkPoses poses;
  ObstacleView view;
  Clearance clearance;
  VelocityRange range;
  TaskJacobian jacobian;
  bool is_stopping = false;

  explicit Scene(const JointVector& start_rad) : q_rad(start_rad), poses(forward_kinematics(model().arm, start_rad)) {
    jacobian = tool_jacobian(poses, 3);
    range = sustainable_range(model().arm.limits, q_rad, q_rad, kPeriod_s);
    measure();
  }

  void measure() {
    const ShieldSettings& settings = model().settings.shield;
    view.set = set.get();
    clearance = measure_clearance(model().arm, poses, view, {settings.range_m, settings.pass_horizon_s});
  }

  void add_sphere_toward(const Vector3& goal_m, const Vector3& from, double distance_m, double speed_mps) {
    Obstacle& sphere = set->obstacles[static_cast<size_t>(set->count)];
    sphere = sphere_obstacle(goal_m + distance_m * from, 0.05);
    sphere.velocity_mps = -speed_mps * from;
    sphere.id = set->count++;
    measure();
  }

  ShieldInput input() const {
    return {model().arm,
            poses,
            q_rad,
            q_rad,
            rest,
            clearance,
            view,
            model().self_pairs,
            evasion_radps,
            kPeriod_s,
            model().settings.shield.comfort_least_weight,
            model().settings.shield.tool_weight,
            0.0,
            is_stopping};
  }
  QpObjective objective() const {
    const ShieldSettings& settings = model().settings.shield;
    return {rest, jacobian, settings.tool_weight, settings.comfort_least_weight};
  }
  ConstraintRows rows() const {
    return make_rows(model().settings.shield, input(), range, range, JointVector::Zero(7)).plan;
  }
  JointVector planned() const { return solve(rows(), range, objective()).velocity_radps; }
  Plan evaded() const { return evade(model().settings.shield, input(), rows(), range, objective(), planned()); }

  /// Least clearance until 0.2 s after the last closest approach while the arm accelerates to a velocity and keeps it,
  /// integrated in steps of 1 ms and looked at every 70 ms, as the rollouts of the evasion do. Unless the arm is
  /// stopping, what is more than 0.3 s ahead counts as farther away by 0.05 m for each further second.
  double least_clearance_m(const JointVector& velocity_radps) const {
    const double dt_s = 0.001;
    const JointLimits& limits = model().arm.limits;
    const JointVector change = limits.acceleration_radps2 * dt_s;
    JointVector q = q_rad, qd = rest;
    double least_m = 1.0, last_s = 0.0;
    for (const NearPair& pair : clearance.near)
      if (pair.approach.distance_m < model().settings.shield.pass_clearance_m)
        last_s = std::max(last_s, pair.approach.time_s);
    for (int i = 1; i * dt_s <= last_s + 0.2; ++i) {
      qd += (velocity_radps - qd).cwiseMax(-change).cwiseMin(change);
      q = (q + qd * dt_s).cwiseMax(limits.lower_rad).cwiseMin(limits.upper_rad);
      if (i % 70 != 0) continue;
      const double later_m =
          is_stopping ? 0.0 : std::clamp(0.05 * (i * dt_s - 0.3), 0.0, model().settings.shield.hard_clearance_m);
      const double found_m = clearance_after(model().arm, forward_kinematics(model().arm, q), set->obstacles.data(),
                                             set->count, i * dt_s, 1.0);
      least_m = std::min(least_m, found_m + later_m);
    }
    return least_m;
  }
};

/// A point on the axis of a random link that moves.
Vector3 on_the_arm(const Scene& scene, Random& random) {
  const auto& shapes = model().arm.shapes;
  size_t s = 0;
  while (shapes[s].body < 3) s = static_cast<size_t>(random.index(static_cast<int>(shapes.size())));
  const Capsule link = transformed(scene.poses, shapes[s]);
  return link.start + random.uniform(0.2, 0.8) * (link.end - link.start);
}

/// Scenes in which spheres arrive within pass_horizon_s.
Scene threatened_scene(Random& random, double soonest_s = 0.3, double latest_s = 0.45) {
  Scene scene(random.configuration(model().arm, 0.7));
  const double speed_mps = random.uniform(0.8, 2.0);
  for (int i = random.index(2); i >= 0; --i)
    scene.add_sphere_toward(on_the_arm(scene, random), random.direction(),
                            speed_mps * random.uniform(soonest_s, latest_s), speed_mps);
  return scene;
}

void without_an_approaching_obstacle_the_plan_stays(void**) {
  Random random(1);
  for (int trial = 0; trial < 200; ++trial) {
    Scene scene(random.configuration(model().arm, 0.7));
    const Vector3 from = random.direction();
    scene.add_sphere_toward(on_the_arm(scene, random), from, 0.3, trial % 2 == 0 ? 0.0 : -1.0);
    const JointVector planned = scene.planned();
    const Plan plan = scene.evaded();
    assert_false(plan.evading);
    check_near(plan.velocity_radps, planned, 0);
  }
}

void the_evasion_is_within_the_range_and_keeps_more_clearance_than_the_plan(void**) {
  Random random(2);
  int evasions = 0, improved = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    Scene scene = threatened_scene(random);
    scene.is_stopping = trial % 2 == 0;
    const JointVector planned = scene.planned();
    const Plan plan = scene.evaded();
    assert_true((plan.velocity_radps.array() >= scene.range.lower_radps.array() - 1e-9).all());
    assert_true((plan.velocity_radps.array() <= scene.range.upper_radps.array() + 1e-9).all());
    if (!plan.evading) continue;
    ++evasions;
    const double hard_m = model().settings.shield.hard_clearance_m, rollout_error_m = 0.02;
    const double before_m = std::min(hard_m, scene.least_clearance_m(planned));
    const double after_m = std::min(hard_m, scene.least_clearance_m(plan.velocity_radps));
    check(after_m >= before_m - rollout_error_m, "trial %d: %g m instead of %g m", trial, after_m, before_m);
    improved += after_m > before_m + 0.005;
  }
  check(evasions > 100, "only %d evasions", evasions);
  check(improved > evasions / 4, "only %d of %d evasions improve the clearance", improved, evasions);
}

/// The factor for the evasion of the previous cycle keeps the choice.
void the_evasion_of_the_previous_cycle_is_kept(void**) {
  Random random(3);
  int evasions = 0;
  for (int trial = 0; trial < 500; ++trial) {
    Scene scene = threatened_scene(random);
    const Plan first = scene.evaded();
    if (!first.evading) continue;
    ++evasions;
    scene.evasion_radps = first.velocity_radps;
    const Plan second = scene.evaded();
    assert_true(second.evading);
    check_near(second.velocity_radps, first.velocity_radps, 0);
  }
  check(evasions > 30, "only %d evasions", evasions);
}

/// Limbs turn back. Without separation such persons are evaded.
void a_person_who_comes_later_than_in_0_3_s_is_not_evaded_yet(void**) {
  Random random(6);
  int soon = 0, late = 0;
  for (int trial = 0; trial < 300; ++trial) {
    Scene scene = threatened_scene(random, 0.15, 0.45);
    ShieldInput input = scene.input();
    double first_s = 1.0;
    for (const NearPair& pair : scene.clearance.near)
      if (pair.approach.time_s > 0.0) first_s = std::min(first_s, pair.approach.time_s);
    const auto evades = [&] {
      const auto& settings = model().settings.shield;
      const ConstraintRows rows = make_rows(settings, input, scene.range, scene.range, scene.rest).plan;
      return evade(settings, input, rows, scene.range, scene.objective(), scene.rest).evading;
    };
    for (int i = 0; i < scene.set->count; ++i) scene.set->obstacles[static_cast<size_t>(i)].kind = Kind::kPerson;
    if (!evades()) continue;
    input.person_weight = model().settings.shield.person_weight;
    const bool still_evades = evades();
    if (first_s > 0.3) assert_false(still_evades);
    late += first_s > 0.3;
    soon += still_evades;
  }
  check(soon > 20 && late > 20, "%d soon, %d late", soon, late);
}

/// The same rows, plans and candidates: only the cost differs.
void beside_persons_the_evasion_stays_near_the_plan_which_makes_room(void**) {
  Random random(5);
  double kept_radps = 0.0, given_up_radps = 0.0;
  int evasions = 0;
  for (int trial = 0; trial < 500; ++trial) {
    Scene scene = threatened_scene(random, 0.1, 0.25);
    for (int i = 0; i < scene.set->count; ++i) scene.set->obstacles[static_cast<size_t>(i)].kind = Kind::kPerson;
    ShieldInput separating = scene.input(), tracking = scene.input();
    separating.person_weight = model().settings.shield.person_weight;
    const auto& settings = model().settings.shield;
    const ConstraintRows rows = make_rows(settings, separating, scene.range, scene.range, scene.rest).plan;
    const JointVector planned = solve(rows, scene.range, scene.objective()).velocity_radps;
    const Plan near = evade(settings, separating, rows, scene.range, scene.objective(), planned);
    const Plan far = evade(settings, tracking, rows, scene.range, scene.objective(), planned);
    if (!near.evading || !far.evading) continue;
    ++evasions;
    kept_radps += (near.velocity_radps - planned).norm();
    given_up_radps += (far.velocity_radps - planned).norm();
  }
  check(evasions > 50 && kept_radps < 0.9 * given_up_radps, "%d evasions, %g and %g rad/s from the plan", evasions,
        kept_radps / evasions, given_up_radps / evasions);
}

/// The projections of the joints on the null space, by a singular value decomposition. Such a motion that keeps the
/// clearance, as large as the range permits, leaves the tool where it is; the cheapest candidate moves the tool no
/// faster than costs as much.
void the_tool_is_kept_where_a_motion_in_its_null_space_evades(void**) {
  Random random(6);
  constexpr double kToolWeight = 600.0, kRolloutError_m = 0.005;
  const double hard_m = model().settings.shield.hard_clearance_m;
  for (const int rows : {3, 6}) {
    int checked = 0;
    for (int trial = 0; trial < 6000; ++trial) {
      Scene scene(random.configuration(model().arm, 0.7));
      scene.add_sphere_toward(on_the_arm(scene, random) + 0.08 * random.direction(), random.direction(), 0.36, 0.8);
      scene.jacobian = tool_jacobian(scene.poses, rows);
      const QpObjective objective{scene.rest, scene.jacobian, kToolWeight, 0.2};
      const JointVector planned = solve(scene.rows(), scene.range, objective).velocity_radps;
      const Plan plan = evade(model().settings.shield, scene.input(), scene.rows(), scene.range, objective, planned);
      const Eigen::JacobiSVD<Eigen::MatrixXd> svd(scene.jacobian, Eigen::ComputeFullV);
      if (!plan.evading || svd.singularValues()[rows - 1] < 0.1) continue;
      const Eigen::MatrixXd null_space = svd.matrixV().rightCols(7 - rows);
      for (int i = 0; i < 14; ++i) {
        JointVector aside = (i % 2 == 0 ? 1.0 : -1.0) * (null_space * null_space.row(i / 2).transpose());
        if (aside.norm() < 0.2) continue;
        const JointVector shares =
            aside.cwiseQuotient(scene.range.upper_radps).cwiseMax(aside.cwiseQuotient(scene.range.lower_radps));
        aside /= shares.maxCoeff();
        if (scene.least_clearance_m(aside) < hard_m + kRolloutError_m) continue;
        const double tool = (scene.jacobian * plan.velocity_radps).norm();
        const double most = aside.norm() / std::sqrt(kToolWeight);
        check(tool < most + 0.01, "trial %d: the tool moves with %g instead of %g at most", trial, tool, most);
        ++checked;
      }
    }
    check(checked > 20, "%d rows: only %d motions", rows, checked);
  }
}

/// An arm that tracks leaves to later cycles what an arm that stops evades at once.
void what_comes_later_may_come_nearer_unless_the_arm_stops(void**) {
  Random random(7);
  constexpr double kRolloutError_m = 0.007;
  const ShieldSettings& settings = model().settings.shield;
  int left_to_later = 0, evaded = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    Scene scene(random.configuration(model().arm, 0.7));
    const double speed_mps = random.uniform(0.3, 0.8);
    scene.add_sphere_toward(on_the_arm(scene, random) + 0.1 * random.direction(), random.direction(),
                            0.6 * speed_mps + 0.1, speed_mps);
    const ConstraintRows rows = scene.rows();
    if (largest_pass_mps(rows) <= 0.0) continue;
    const JointVector planned = scene.planned();
    const double later_m = scene.least_clearance_m(planned);
    const bool evades_later = scene.evaded().evading;
    scene.is_stopping = true;
    const double exact_m = scene.least_clearance_m(planned);
    const bool evades_at_once = scene.evaded().evading;
    if (later_m < settings.hard_clearance_m - kRolloutError_m) {
      check(evades_later && evades_at_once, "trial %d: does not evade at %g m", trial, later_m);
      ++evaded;
    } else if (later_m > settings.hard_clearance_m + kRolloutError_m) {
      check(!evades_later, "trial %d: evades at %g m", trial, later_m);
      if (exact_m > settings.hard_clearance_m - kRolloutError_m) continue;
      check(evades_at_once, "trial %d: a stopping arm does not evade at %g m", trial, exact_m);
      ++left_to_later;
    }
  }
  check(left_to_later > 30 && evaded > 30, "only %d left to later, %d evaded", left_to_later, evaded);
}

void equal_inputs_give_equal_evasions(void**) {
  Random random(4);
  for (int trial = 0; trial < 100; ++trial) {
    const Scene scene = threatened_scene(random);
    check_near(scene.evaded().velocity_radps, scene.evaded().velocity_radps, 0);
  }
}

/// 24 small spheres at rest, too far away to matter, in front of the list of obstacles or behind it.
Scene with_decoys(const Scene& threatened, bool in_front, unsigned seed) {
  Random random(seed);
  Scene scene(threatened.q_rad);
  const int threats = threatened.set->count;
  const auto add = [&](const Obstacle& obstacle) {
    scene.set->obstacles[static_cast<size_t>(scene.set->count++)] = obstacle;
  };
  const auto add_threats = [&] {
    for (int i = 0; i < threats; ++i) add(threatened.set->obstacles[static_cast<size_t>(i)]);
  };
  if (!in_front) add_threats();
  for (int decoys = 0; decoys < 24;) {
    const Obstacle decoy = sphere_obstacle(random.inside(-1.0, 1.3), 0.01);
    const double distance_m = clearance_after(model().arm, scene.poses, &decoy, 1, 0.0, 1.0);
    if (distance_m < 0.25 || distance_m > 0.38) continue;
    add(decoy);
    ++decoys;
  }
  if (in_front) add_threats();
  scene.measure();
  return scene;
}

void decoys_in_front_of_the_list_do_not_change_the_evasion(void**) {
  Random random(5);
  int evasions = 0;
  for (unsigned trial = 0; trial < 300; ++trial) {
    const Scene scene = threatened_scene(random);
    const Plan behind = with_decoys(scene, false, trial).evaded(), in_front = with_decoys(scene, true, trial).evaded();
    evasions += behind.evading;
    assert_int_equal(in_front.evading, behind.evading);
    check_near_because(in_front.velocity_radps, behind.velocity_radps, 1e-6, "trial %u", trial);
  }
  check(evasions > 20, "only %d evasions", evasions);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(without_an_approaching_obstacle_the_plan_stays),
      cmocka_unit_test(the_evasion_is_within_the_range_and_keeps_more_clearance_than_the_plan),
      cmocka_unit_test(the_evasion_of_the_previous_cycle_is_kept),
      cmocka_unit_test(a_person_who_comes_later_than_in_0_3_s_is_not_evaded_yet),
      cmocka_unit_test(beside_persons_the_evasion_stays_near_the_plan_which_makes_room),
      cmocka_unit_test(the_tool_is_kept_where_a_motion_in_its_null_space_evades),
      cmocka_unit_test(what_comes_later_may_come_nearer_unless_the_arm_stops),
      cmocka_unit_test(equal_inputs_give_equal_evasions),
      cmocka_unit_test(decoys_in_front_of_the_list_do_not_change_the_evasion),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
