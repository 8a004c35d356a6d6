#include "host/sim/grasp.h"

#include "host/sim/truth.h"
#include "tests/support/check.h"

using namespace sidestep::sim;
using Eigen::Vector3d;

namespace {

/// A can at (1, 0, 0) on a table, which the tool takes at 1 s and puts down at 2 s.
World world() {
  World world;
  world.obstacles.resize(2);
  world.obstacles[0] = {4, {Shape::kCylinder, {0.03, 0.1, 0}}, {}, false};
  world.obstacles[0].motion.position_m = {1, 0, 0};
  world.obstacles[1] = {5, {Shape::kBox, {1, 1, 0.1}}, {}, false};
  world.obstacles[1].motion.position_m = {1, 0, -0.1};
  return world;
}

const std::vector<GraspStep> kSteps{{0.5, {}, {4}}, {1.0, {4}, {5}}, {2.0, {}, {}}};

Eigen::Isometry3d tool_at(const Vector3d& position_m, double turn_rad) {
  return Eigen::Translation3d(position_m) * Eigen::AngleAxisd(turn_rad, Vector3d::UnitZ());
}

void an_obstacle_moves_with_the_tool_that_holds_it_and_stays_where_it_lets_go(void**) {
  Grasp grasp(kSteps);
  const auto can_at = [&](double t_s, const Eigen::Isometry3d& tool) {
    World now = world();
    grasp.apply(t_s, tool, now);
    return now.obstacles[0].motion.position_m;
  };
  assert_true(can_at(0.0, tool_at({0.9, 0, 0}, 0.0)).isApprox(Vector3d(1, 0, 0)));
  assert_true(can_at(1.0, tool_at({0.9, 0, 0}, 0.0)).isApprox(Vector3d(1, 0, 0)));  // taken, 0.1 m ahead of the tool
  assert_true(can_at(1.5, tool_at({0, 2, 0}, M_PI / 2)).isApprox(Vector3d(0, 2.1, 0)));
  assert_true(can_at(2.0, tool_at({0, 3, 0}, M_PI / 2)).isApprox(Vector3d(0, 3.1, 0)));  // put down
  assert_true(can_at(2.5, tool_at({5, 5, 5}, 0.0)).isApprox(Vector3d(0, 3.1, 0)));
}

void the_grip_is_that_of_the_last_step(void**) {
  Grasp grasp(kSteps);
  const auto grip_at = [&](double t_s) {
    World now = world();
    grasp.apply(t_s, tool_at({0.9, 0, 0}, 0.0), now);
    return *now.grip;
  };
  assert_true(!grip_at(0.0).allows(4));
  assert_true(grip_at(0.5).allows(4) && !grip_at(0.6).holds(4));
  const Grip grip = grip_at(1.2);
  assert_true(grip.holds(4) && grip.allows(5) && grip.allows(4));
  assert_true(grip.held[0].motion.position_m.isApprox(Vector3d(0.1, 0, 0)));
  assert_true(!grip_at(2.0).holds(4));
}

void a_world_without_steps_stays_as_it_is(void**) {
  World now = world();
  Grasp({}).apply(1.0, tool_at({0, 0, 0}, 0.0), now);
  assert_false(now.grip.has_value());
}

void the_truth_counts_what_is_held_as_a_link_and_leaves_out_what_is_allowed(void**) {
  Truth truth(Arm("urdf/lwa3.urdf", "base_link", "tool"));
  truth.place(JointVector::Zero(7));
  const Vector3d tool_m = truth.tool_m();
  World now = world();
  now.obstacles[0].motion.position_m = tool_m + Vector3d(0, 0, 0.3);   // held, far from the links
  now.obstacles[1].motion.position_m = tool_m + Vector3d(0, 0, 0.42);  // 20 mm above the can
  now.grip = Grip{{now.obstacles[0]}, {}};
  now.grip->held[0].motion.position_m = truth.arm().base_from_tool().inverse() * now.obstacles[0].motion.position_m;
  now.grip->held[0].motion.orientation = Eigen::Quaterniond(truth.arm().base_from_tool().linear().transpose());
  const Nearest held = truth.nearest_in(now);
  check_near(held.clearance_m, 0.02, 1e-3);
  assert_string_equal(held.link.c_str(), "held object");
  assert_int_equal(held.obstacle, 1);
  now.grip->allowed = {5};
  check(truth.nearest_in(now).clearance_m > 0.1, "%g", truth.nearest_in(now).clearance_m);
  now.grip->held.clear();
  now.grip->allowed = {4};
  now.obstacles[0].motion.position_m = tool_m;  // in the hand, allowed
  check(truth.nearest_in(now).clearance_m > 0.0, "%g", truth.nearest_in(now).clearance_m);
  now.grip->allowed.clear();
  check(truth.nearest_in(now).clearance_m < 0.0, "%g", truth.nearest_in(now).clearance_m);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(an_obstacle_moves_with_the_tool_that_holds_it_and_stays_where_it_lets_go),
      cmocka_unit_test(the_grip_is_that_of_the_last_step),
      cmocka_unit_test(a_world_without_steps_stays_as_it_is),
      cmocka_unit_test(the_truth_counts_what_is_held_as_a_link_and_leaves_out_what_is_allowed),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
