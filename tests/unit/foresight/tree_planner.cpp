#include "firmware/foresight/tree_planner.h"

#include <memory>

#include "firmware/io/config/config.h"
#include "firmware/model/link_proximity.h"
#include "firmware/model/prediction.h"
#include "tests/support/check.h"
#include "tests/support/closed_loop.h"
#include "tests/support/lwa3.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::lwa3;
using test::Random;

namespace {

const Model& model() {
  static const Model model = test::lwa3_model("sidestep");
  return model;
}

void add(Snapshot& snapshot, const Obstacle& obstacle) {
  snapshot.nearby.obstacles[static_cast<size_t>(snapshot.nearby.count++)] = obstacle;
}

/// Least distance to the obstacles, by the tested function of the shield.
double clearance_m(const Snapshot& snapshot, const JointVector& q_rad) {
  return clearance_after(lwa3(), forward_kinematics(lwa3(), q_rad), snapshot.nearby.obstacles.data(),
                         snapshot.nearby.count, 0.0, 1.0);
}

/// Least distance of two links above their clearance.
double self_room_m(const JointVector& q_rad) {
  const LinkPoses poses = forward_kinematics(lwa3(), q_rad);
  double least_m = HUGE_VAL;
  for (const SelfPair& pair : model().self_pairs) {
    const auto& shapes = lwa3().shapes;
    const Capsule a = transformed(poses, shapes[static_cast<size_t>(pair.first)]);
    const Capsule b = transformed(poses, shapes[static_cast<size_t>(pair.second)]);
    least_m = std::min(least_m, measure_pair(a, b).distance_m - pair.clearance_m);
  }
  return least_m;
}

JointVector free_configuration(const Snapshot& snapshot, Random& random) {
  while (true) {
    const JointVector q_rad = random.configuration(lwa3(), 0.8);
    if (clearance_m(snapshot, q_rad) > 0.02 && self_room_m(q_rad) > 0.005) return q_rad;
  }
}

/// Eight boxes and cylinders at rest, the arm in a free configuration and the target in another one, with its
/// orientation every other time.
std::unique_ptr<Snapshot> random_world(Random& random) {
  auto snapshot = std::make_unique<Snapshot>();
  snapshot->moves = snapshot->tracking = true;
  snapshot->now_s = 3.0;
  for (int i = 0; i < 8; ++i) {
    Vector3 centre = random.inside(-0.9, 0.9);
    while (centre.head<2>().norm() < 0.35) centre = random.inside(-0.9, 0.9);
    const Matrix3 turn = random.turn().toRotationMatrix();
    add(*snapshot, i % 2 ? box_obstacle(centre, turn, random.inside(0.02, 0.5))
                         : cylinder_obstacle(centre, turn, random.uniform(0.02, 0.1), random.uniform(0.1, 0.6)));
  }
  snapshot->arm.position_rad = free_configuration(*snapshot, random);
  snapshot->arm.velocity_radps = JointVector::Zero(7);
  const LinkPoses goal = forward_kinematics(lwa3(), free_configuration(*snapshot, random));
  snapshot->target.position_m = goal.tool_position;
  snapshot->target.tracks_orientation = random.chance(0.5);
  snapshot->target.orientation = Quaternion(goal.tool_rotation);
  return snapshot;
}

Guide plan(TreePlanner& planner, const Snapshot& snapshot, int slices = 200) {
  for (int i = 0; i < slices; ++i) {
    const Guide guide = planner.plan(snapshot);
    if (guide.knots > 0) return guide;
  }
  return {};
}

void plans_are_free_and_end_at_the_target(void**) {
  Random random(1);
  int found = 0;
  for (int trial = 0; trial < 40; ++trial) {
    const auto snapshot = random_world(random);
    const auto planner = std::make_unique<TreePlanner>(model());
    const Guide guide = plan(*planner, *snapshot);
    if (guide.knots == 0) continue;
    ++found;
    assert_int_equal(static_cast<int>(guide.foresight_status), static_cast<int>(ForesightStatus::kGuided));
    assert_true(guide.position_rad[0] == snapshot->arm.position_rad);
    const double rest_m = model().settings.shield.rest_clearance_m;
    for (double at_s = guide.time_s[0]; at_s < guide.end_s(); at_s += 0.002) {
      const JointVector q_rad = point_of(guide, at_s).position_rad;
      check(clearance_m(*snapshot, q_rad) > 0.5 * rest_m, "trial %d: %g m", trial, clearance_m(*snapshot, q_rad));
      check(self_room_m(q_rad) > -0.005, "trial %d: %g m", trial, self_room_m(q_rad));
    }
    const LinkPoses end = forward_kinematics(lwa3(), point_of(guide, guide.end_s()).position_rad);
    check_near(end.tool_position, snapshot->target.position_m, 1e-3);
    if (snapshot->target.tracks_orientation)
      check(Quaternion(end.tool_rotation).angularDistance(snapshot->target.orientation) < 1.1e-2, "trial %d", trial);
  }
  check(found >= 36, "only %d of 40 were found", found);  // a goal whose way takes more than the horizon is none
}

/// The first joint has no limits and has made three turns: the plan is that without the turns.
void a_joint_that_was_wound_up_is_not_unwound(void**) {
  constexpr double kTurns_rad = 6.0 * M_PI;
  Model continuous = model();
  continuous.arm.limits.lower_rad[0] = -HUGE_VAL;
  continuous.arm.limits.upper_rad[0] = HUGE_VAL;
  Random random(5);
  int found = 0;
  for (int trial = 0; trial < 6; ++trial) {
    const auto snapshot = random_world(random);
    const auto planner = std::make_unique<TreePlanner>(continuous);
    const Guide guide = plan(*planner, *snapshot);
    snapshot->arm.position_rad[0] += kTurns_rad;
    planner->reset();
    const Guide wound_up = plan(*planner, *snapshot);
    assert_int_equal(wound_up.knots, guide.knots);
    for (int k = 0; k < guide.knots; ++k)
      check_near(wound_up.position_rad[k][0], guide.position_rad[k][0] + kTurns_rad, 1e-6);
    found += guide.knots > 0;
  }
  check(found >= 4, "only %d plans were found", found);
}

/// The tool reaches through a window of 30 cm in a wall that is wider than the arm.
void a_path_leads_through_a_window(void**) {
  Snapshot snapshot;
  snapshot.moves = snapshot.tracking = true;
  const double wall_m = 0.4, half_m = 0.15, height_m = 0.6;
  for (const double side : {-1.0, 1.0}) {
    add(snapshot, box_obstacle({wall_m, side * (half_m + 0.5), 0.6}, Matrix3::Identity(), {0.02, 1.0, 2.0}));
    add(snapshot, box_obstacle({wall_m, 0, height_m + side * (half_m + 0.4)}, Matrix3::Identity(), {0.02, 0.3, 0.8}));
  }
  snapshot.arm.position_rad = test::home_rad();
  snapshot.arm.position_rad[0] = M_PI;
  snapshot.arm.velocity_radps = JointVector::Zero(7);
  snapshot.target.position_m = Vector3(wall_m + 0.15, 0, height_m);
  const auto planner = std::make_unique<TreePlanner>(model());
  const Guide guide = plan(*planner, snapshot, 1000);
  assert_true(guide.knots > 0);
  for (double at_s = 0.0; at_s < guide.end_s(); at_s += 0.002)
    assert_true(clearance_m(snapshot, point_of(guide, at_s).position_rad) > 0.002);
}

void the_same_snapshots_give_the_same_plan(void**) {
  Random random(2);
  const auto snapshot = random_world(random);
  const auto one = std::make_unique<TreePlanner>(model()), two = std::make_unique<TreePlanner>(model());
  const Guide first = plan(*one, *snapshot), second = plan(*two, *snapshot);
  assert_true(first.knots > 0);
  assert_int_equal(first.knots, second.knots);
  for (size_t k = 0; k < static_cast<size_t>(first.knots); ++k)
    check_near(first.position_rad[k], second.position_rad[k], 0.0);
}

void a_target_that_moves_has_no_plan(void**) {
  Random random(3);
  const auto snapshot = random_world(random);
  snapshot->target.velocity_mps.x() = 0.1;
  const auto planner = std::make_unique<TreePlanner>(model());
  assert_int_equal(plan(*planner, *snapshot, 50).knots, 0);
}

/// The hand reaches into an open box. With 1 % of the seeds no way leads from the arm to any of the first goals.
void a_search_whose_goals_are_cut_off_goes_on_with_others(void**) {
  Snapshot snapshot;
  snapshot.moves = snapshot.tracking = true;
  const Matrix3 turn = Quaternion(0.737, 0, 0, 0.676).normalized().toRotationMatrix();
  const auto add_board = [&](double x, double y, double z, const Vector3& size) {
    add(snapshot, box_obstacle({x, y, z}, turn, size));
  };
  add_board(-0.084, 0.363, 0.012, {0.449, 0.375, 0.02});
  add_board(-0.103, 0.149, 0.189, {0.02, 0.375, 0.333});
  add_board(-0.065, 0.576, 0.189, {0.02, 0.375, 0.333});
  add_board(0.093, 0.347, 0.189, {0.409, 0.02, 0.333});
  add_board(-0.261, 0.378, 0.189, {0.409, 0.02, 0.333});
  snapshot.arm.position_rad = JointVector(7);
  snapshot.arm.position_rad << 1.819, -1.017, -0.674, -2.060, 1.087, 2.609, -1.871;
  snapshot.arm.velocity_radps = JointVector::Zero(7);
  snapshot.target.position_m = Vector3(-0.041, 0.385, 0.068);
  snapshot.target.tracks_orientation = true;
  snapshot.target.orientation = Quaternion(0.2565, -0.0881, 0.9572, -0.1012).normalized();
  Model panda = load_config("firmware/config/panda.yaml", {}).model;
  for (uint64_t seed = 0; seed < 200; ++seed) {
    panda.settings.foresight.seed = seed;
    const auto planner = std::make_unique<TreePlanner>(panda);
    int slices = 0;
    while (slices < 150 && planner->plan(snapshot).knots == 0) ++slices;
    check(slices < 150, "seed %d: %d slices", static_cast<int>(seed), slices);
  }
}

void check_clear_in_time(const Snapshot& snapshot, const Guide& guide, const Obstacle& mover, int trial) {
  for (double after_s = 0.0; after_s < model().settings.foresight.horizon_s; after_s += 0.06) {
    const LinkPoses poses = forward_kinematics(lwa3(), point_of(guide, snapshot.now_s + after_s).position_rad);
    const double clear_m = clearance_after(lwa3(), poses, &mover, 1, after_s, 1.0);
    check(clear_m >= model().settings.foresight.clearance_m - 1e-9, "trial %d: %g m", trial, clear_m);
  }
}

/// Of plans past a mover: how many trials had one in the way, and for how many of them there is a plan, all of which
/// keep clear.
struct Passes {
  int blocked = 0, found = 0;
};

/// make_mover(tool_m, after_s): an obstacle in the way of an arm whose tool is at that place then.
template <typename MakeMover>
Passes plan_past(Random& random, const MakeMover& make_mover) {
  Passes passes;
  for (int trial = 0; trial < 30; ++trial) {
    const auto snapshot = random_world(random);
    const auto planner = std::make_unique<TreePlanner>(model());
    const Guide alone = plan(*planner, *snapshot);
    if (alone.knots == 0) continue;
    const double middle_s = 0.5 * (alone.end_s() - snapshot->now_s);
    const LinkPoses there = forward_kinematics(lwa3(), point_of(alone, snapshot->now_s + middle_s).position_rad);
    const Obstacle mover = make_mover(there.tool_position, middle_s);
    add(*snapshot, mover);
    planner->reset();
    const Guide guide = plan(*planner, *snapshot);
    ++passes.blocked;
    if (guide.knots == 0) continue;
    ++passes.found;
    check_clear_in_time(*snapshot, guide, mover, trial);
  }
  return passes;
}

/// A ball flies through the middle of the way while the arm would be there.
void a_plan_lets_a_moving_obstacle_pass(void**) {
  Random random(4);
  const Passes passes = plan_past(random, [&](const Vector3& tool_m, double after_s) {
    const Vector3 velocity_mps = 0.5 * random.direction();
    Obstacle ball = sphere_obstacle(tool_m - after_s * velocity_mps, 0.05);
    ball.velocity_mps = velocity_mps;
    return ball;
  });
  check(passes.found * 2 > passes.blocked, "%d of %d", passes.found, passes.blocked);
}

/// A board at rest beside the way turns into it while the arm would be there.
void a_plan_lets_a_board_that_turns_on_the_spot_pass(void**) {
  Random random(5);
  const Passes passes = plan_past(random, [&](const Vector3& tool_m, double after_s) {
    const double beside_m = 0.2;
    const Vector3 axis = random.direction(), toward = axis.unitOrthogonal();
    const Matrix3 then = Quaternion::FromTwoVectors(Vector3::UnitX(), toward).toRotationMatrix();
    Obstacle board =
        box_obstacle(tool_m - beside_m * toward, Eigen::AngleAxisd(-M_PI / 2, axis) * then, {0.5, 0.02, 0.02});
    board.angular_velocity_radps = M_PI / 2 / after_s * axis;
    return board;
  });
  check(passes.found * 3 > passes.blocked, "%d of %d", passes.found, passes.blocked);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(plans_are_free_and_end_at_the_target),
      cmocka_unit_test(a_joint_that_was_wound_up_is_not_unwound),
      cmocka_unit_test(a_path_leads_through_a_window),
      cmocka_unit_test(the_same_snapshots_give_the_same_plan),
      cmocka_unit_test(a_target_that_moves_has_no_plan),
      cmocka_unit_test(a_search_whose_goals_are_cut_off_goes_on_with_others),
      cmocka_unit_test(a_plan_lets_a_moving_obstacle_pass),
      cmocka_unit_test(a_plan_lets_a_board_that_turns_on_the_spot_pass),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
