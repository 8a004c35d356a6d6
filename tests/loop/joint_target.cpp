// Postures as goals (joint_target_t), and goals that cannot be reached.

#include <set>

#include "firmware/model/link_proximity.h"
#include "tests/support/allocation_count.h"
#include "tests/support/check.h"
#include "tests/support/foresight_loop.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::ClosedLoop;
using test::point_target;
using test::Random;

namespace {

Target posture(const JointVector& q_rad) {
  Target target;
  target.posture_rad = q_rad;
  return target;
}

/// With what tells whether the arm is in a posture and moves.
struct World : test::ForesightLoop {
  using ForesightLoop::ForesightLoop;

  double error_rad() const { return (loop.arm.position_rad - loop.target.posture_rad).cwiseAbs().maxCoeff(); }
  /// The fastest joint in the coming seconds, rad/s.
  double fastest_radps(double duration_s) {
    double fastest = 0.0;
    for (int i = 0; i < std::lround(duration_s * 100); ++i) {
      cycle();
      fastest = std::max(fastest, loop.arm.velocity_radps.cwiseAbs().maxCoeff());
    }
    return fastest;
  }
};

/// Least distance of two links above their clearance.
double self_room_m(const Model& model, const JointVector& q_rad) {
  const LinkPoses poses = forward_kinematics(model.arm, q_rad);
  double least_m = HUGE_VAL;
  for (const SelfPair& pair : model.self_pairs) {
    const auto& shapes = model.arm.shapes;
    const Capsule a = transformed(poses, shapes[static_cast<size_t>(pair.first)]);
    const Capsule b = transformed(poses, shapes[static_cast<size_t>(pair.second)]);
    least_m = std::min(least_m, measure_pair(a, b).distance_m - pair.clearance_m);
  }
  return least_m;
}

JointVector free_configuration(const World& world, Random& random) {
  while (true) {
    const JointVector q_rad = random.configuration(world.loop.model.arm, 0.8);
    if (world.clearance_m(q_rad) > 0.03 && self_room_m(world.loop.model, q_rad) > 0.01) return q_rad;
  }
}

/// Eight boxes and cylinders at rest.
void add_furniture(World& world, Random& random) {
  for (int i = 0; i < 8; ++i) {
    Vector3 centre = random.inside(-0.9, 0.9);
    while (centre.head<2>().norm() < 0.35) centre = random.inside(-0.9, 0.9);
    const Matrix3 turn = random.turn().toRotationMatrix();
    Obstacle& obstacle = world.loop.add_sphere(centre, Vector3::Zero());
    const int32_t id = obstacle.id;
    obstacle = i % 2 ? box_obstacle(centre, turn, random.inside(0.02, 0.5))
                     : cylinder_obstacle(centre, turn, random.uniform(0.02, 0.1), random.uniform(0.1, 0.6));
    obstacle.id = id;
  }
}

void a_posture_is_reached_exactly_and_at_rest(void**) {
  Random random(1);
  for (int trial = 0; trial < 20; ++trial) {
    World world(posture(test::home_rad()));
    const JointVector goal_rad = free_configuration(world, random);
    world.loop.target = posture(goal_rad);
    world.run(8.0);
    check(world.error_rad() < 1e-4, "trial %d: %g rad away, %s", trial, world.error_rad(),
          world.loop.last.report.message);
    check_near(world.loop.last.report.target_distance_m, 0.0, 1e-4);
    check(world.loop.speed_radps() < 1e-3, "%g rad/s", world.loop.speed_radps());
    assert_string_equal(world.loop.last.report.message, "tracking");
    test::check_stream(world.loop);
  }
}

void the_reported_distance_is_that_of_the_tool_to_its_place_in_the_posture(void**) {
  const JointVector goal_rad = test::home_rad() + JointVector::Constant(7, 0.3);
  World world(posture(goal_rad));
  assert_true(world.loop.run_until(Mode::kTrack, 1.0));
  const double distance_m = (forward_kinematics(test::lwa3(), goal_rad).tool_position -
                             forward_kinematics(test::lwa3(), test::home_rad()).tool_position)
                                .norm();
  check_near(world.loop.last.report.target_distance_m, distance_m, 1e-9);
}

void no_joint_overshoots_the_posture(void**) {
  Random random(2);
  for (int trial = 0; trial < 20; ++trial) {
    World world(posture(test::home_rad()));
    world.foresight.reset();
    const JointVector change_rad = random.joints(7, -0.39, 0.39), goal_rad = test::home_rad() + change_rad;
    world.loop.target = posture(goal_rad);
    for (int i = 0; i < 300; ++i) {
      world.cycle();
      const JointVector beyond_rad = (world.loop.arm.position_rad - goal_rad).cwiseProduct(change_rad.cwiseSign());
      check(beyond_rad.maxCoeff() < 1e-3, "trial %d: %g rad beyond", trial, beyond_rad.maxCoeff());
    }
    check(world.error_rad() < 1e-4, "trial %d: %g rad away", trial, world.error_rad());
  }
}

/// A ball that is in the direct way, unless it would be too near to the start or to the goal.
void add_ball_in_the_way(World& world) {
  const JointVector middle_rad = 0.5 * (world.loop.arm.position_rad + world.loop.target.posture_rad);
  const LinkPoses poses = forward_kinematics(test::lwa3(), middle_rad);
  world.loop.add_sphere(poses.tool_position, Vector3::Zero(), 0.1);
  const double room_m =
      std::min(world.clearance_m(world.loop.arm.position_rad), world.clearance_m(world.loop.target.posture_rad));
  if (room_m < 0.03) --world.loop.obstacles->count;
}

void postures_among_furniture_are_reached_without_contact(void**) {
  Random random(3);
  int reached = 0, guided = 0;
  constexpr int kWorlds = 40;
  for (int trial = 0; trial < kWorlds; ++trial) {
    World world(posture(test::home_rad()));
    add_furniture(world, random);
    world.loop.arm.position_rad = free_configuration(world, random);
    world.loop.target = posture(free_configuration(world, random));
    add_ball_in_the_way(world);
    bool had_guide = false;
    for (int i = 0; i < 1500 && !(world.error_rad() < 1e-4); ++i) {
      world.cycle();
      if (!world.guide || world.guide->knots == 0 || world.guide->foresight_status != ForesightStatus::kGuided)
        continue;
      had_guide = true;
      const JointVector& end_rad = world.guide->position_rad[static_cast<size_t>(world.guide->knots) - 1];
      check_near(end_rad, world.loop.target.posture_rad, 1e-12);
    }
    reached += world.error_rad() < 1e-4;
    guided += had_guide;
    check(world.least_m > 0.001, "trial %d: %g m", trial, world.least_m);
    test::check_stream(world.loop);
  }
  print_message("%d of %d reached, %d with a guide\n", reached, kWorlds, guided);
  check(reached == kWorlds && guided >= 3, "%d reached, %d with a guide", reached, guided);
}

void spheres_that_come_at_the_arm_do_not_touch_it_on_its_way_to_a_posture(void**) {
  Random random(7);
  for (int trial = 0; trial < 60; ++trial) {
    World world(posture(test::home_rad()));
    world.loop.target = posture(free_configuration(world, random));
    world.run(0.7);
    for (int i = 0; i < 3; ++i) {
      const Vector3 tool_m = world.loop.last.report.tool_position_m, from_m = tool_m + 0.7 * random.direction();
      const Vector3 to_m = tool_m + random.inside(-0.1, 0.1);
      world.loop.add_sphere(from_m, random.uniform(0.1, 0.5) * (to_m - from_m).normalized());
      if (world.clearance_m(world.loop.arm.position_rad) < 0.15) --world.loop.obstacles->count;
    }
    world.least_m = 1.0;
    world.run(3.0);
    check(world.least_m > 0.0, "trial %d: %g m", trial, world.least_m);
    test::check_stream(world.loop);
  }
}

void switching_between_postures_and_positions_never_makes_the_commands_jump(void**) {
  Random random(4);
  World world(point_target(Vector3(-0.328, 0.15, 0.8)));
  int postures = 0;
  for (int change = 0; change < 60; ++change) {
    const bool is_posture = random.chance(0.5);
    postures += is_posture;
    world.loop.target =
        is_posture ? posture(free_configuration(world, random))
                   : point_target(forward_kinematics(test::lwa3(), free_configuration(world, random)).tool_position);
    world.run(random.uniform(0.02, 1.0));
    test::check_stream(world.loop);
  }
  assert_true(postures > 20 && postures < 40);
  world.loop.target = posture(test::home_rad());
  world.run(8.0);
  check(world.error_rad() < 1e-4, "%g rad", world.error_rad());
  world.loop.target = point_target(Vector3(-0.328, 0.15, 0.8));
  world.run(4.0);
  check(world.error_m() < 1e-3, "%g m", world.error_m());
  test::check_stream(world.loop);
}

void an_old_posture_leads_to_hold(void**) {
  World world(posture(test::home_rad() + JointVector::Constant(7, 1.0)));
  world.run(0.8);
  assert_true(world.loop.mode() == Mode::kTrack);
  world.loop.sends_target = false;
  world.run(0.24);
  assert_true(world.loop.mode() == Mode::kTrack);
  world.run(0.03);
  assert_true(world.loop.mode() == Mode::kHold && world.loop.reports("the target is too old"));
  world.run(0.5);
  check_near(world.loop.speed_radps(), 0.0, 1e-3);
  test::check_stream(world.loop);
}

void a_posture_in_an_obstacle_is_approached_without_contact_or_chatter(void**) {
  const JointVector goal_rad = test::home_rad() - JointVector::Constant(7, 0.35);
  World world(posture(goal_rad));
  world.loop.add_sphere(forward_kinematics(test::lwa3(), goal_rad).tool_position, Vector3::Zero(), 0.08);
  world.run(8.0);
  check(world.loop.reports("too near to an obstacle"), "%s", world.loop.last.report.message);
  check(world.least_m > 0.002, "%g m", world.least_m);
  check(world.loop.last.report.target_distance_m < 0.25, "%g m", world.loop.last.report.target_distance_m);
  const double fastest = world.fastest_radps(4.0);
  check(fastest < 0.01, "%g rad/s", fastest);
  test::check_stream(world.loop);
  world.loop.obstacles->count = 0;
  world.run(5.0);
  check(world.error_rad() < 1e-4, "%g rad", world.error_rad());
  assert_string_equal(world.loop.last.report.message, "tracking");
}

void a_posture_in_which_the_arm_would_touch_itself_is_said_to_be_so(void**) {
  Random random(5);
  World world(posture(test::home_rad()));
  JointVector goal_rad = test::home_rad();
  while (self_room_m(world.loop.model, goal_rad) > -0.02) goal_rad = random.configuration(test::lwa3());
  world.loop.target = posture(goal_rad);
  world.run(8.0);
  check(world.loop.reports("or to the arm itself"), "%s", world.loop.last.report.message);
  check(self_room_m(world.loop.model, world.loop.arm.position_rad) > -0.005, "%g m",
        self_room_m(world.loop.model, world.loop.arm.position_rad));
  const double fastest = world.fastest_radps(4.0);
  check(fastest < 0.01, "%g rad/s", fastest);
  test::check_stream(world.loop);
}

void a_posture_outside_the_limits_counts_as_the_nearest_one_within(void**) {
  JointVector goal_rad = test::home_rad();
  goal_rad[1] += 0.3;
  goal_rad[5] = 900.0;
  World world(posture(goal_rad));
  world.run(4.0);
  check(world.loop.reports("outside the position limits"), "%s", world.loop.last.report.message);
  world.run(4.0);
  goal_rad[5] = test::lwa3().limits.upper_rad[5];
  check_near(world.loop.arm.position_rad, goal_rad, 1e-4);
  check(world.fastest_radps(2.0) < 1e-3, "the arm moves");
  test::check_stream(world.loop);
}

/// 900 m is farther than the arm is long. The stretched arm cannot turn its tool round.
void a_tool_target_out_of_reach_is_said_to_be_so(void**) {
  const LinkPoses stretched = forward_kinematics(test::lwa3(), JointVector::Zero(7));
  Target turned = point_target(0.97 * stretched.tool_position);
  turned.tracks_orientation = true;
  turned.orientation = Quaternion(stretched.tool_rotation) * Quaternion(Eigen::AngleAxisd(M_PI, Vector3::UnitX()));
  for (const Target& target : {point_target(Vector3(0, 900, 0)), turned}) {
    World world(target);
    world.run(6.0);
    check(world.loop.reports("out of reach"), "%g: %s", target.position_m.y(), world.loop.last.report.message);
    std::set<std::string> messages;
    for (int i = 0; i < 300; ++i) {
      world.cycle();
      messages.insert(world.loop.last.report.message);
    }
    assert_int_equal(messages.size(), 1);
    test::check_stream(world.loop);
    world.loop.target = point_target(Vector3(-0.328, 0.15, 0.8));
    world.run(0.1);
    assert_string_equal(world.loop.last.report.message, "tracking");
  }
}

void a_target_within_reach_is_never_said_to_be_out_of_reach(void**) {
  Random random(6);
  int tried = 0;
  for (int trial = 0; trial < 20; ++trial) {
    World world(posture(test::home_rad()));
    if (trial % 2) add_furniture(world, random);
    world.loop.target = point_target(forward_kinematics(test::lwa3(), free_configuration(world, random)).tool_position);
    if (world.clearance_m(world.loop.arm.position_rad) < 0.02) continue;
    ++tried;
    for (int i = 0; i < 400; ++i) {
      world.cycle();
      check(!world.loop.reports("out of reach"), "trial %d, cycle %d", trial, i);
    }
  }
  check(tried >= 15, "%d of 20 tried", tried);
}

void the_law_of_the_paper_moves_the_tool_to_its_place_in_the_posture(void**) {
  World world(posture(test::home_rad() + JointVector::Constant(7, 0.1)), test::home_rad(), "paper");
  world.run(8.0);
  check_near(world.loop.last.report.target_distance_m, 0.0, 1e-3);
  test::check_stream(world.loop);
}

void the_same_inputs_give_the_same_commands_and_nothing_allocates(void**) {
  const JointVector goal_rad = test::home_rad() + JointVector::Constant(7, 0.8);
  World one(posture(goal_rad)), other(posture(goal_rad));
  for (World* world : {&one, &other})
    world->loop.add_sphere(forward_kinematics(test::lwa3(), goal_rad).tool_position + Vector3(0.15, 0, 0),
                           Vector3::Zero(), 0.1);
  int64_t before = 0;
  for (int i = 0; i < 500; ++i) {
    if (i == 70) before = test::allocation_count();
    one.cycle();
    other.cycle();
    assert_true(one.loop.last.command.velocity_radps == other.loop.last.command.velocity_radps);
  }
  assert_int_equal(test::allocation_count() - before, 0);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_posture_is_reached_exactly_and_at_rest),
      cmocka_unit_test(the_reported_distance_is_that_of_the_tool_to_its_place_in_the_posture),
      cmocka_unit_test(no_joint_overshoots_the_posture),
      cmocka_unit_test(postures_among_furniture_are_reached_without_contact),
      cmocka_unit_test(spheres_that_come_at_the_arm_do_not_touch_it_on_its_way_to_a_posture),
      cmocka_unit_test(switching_between_postures_and_positions_never_makes_the_commands_jump),
      cmocka_unit_test(an_old_posture_leads_to_hold),
      cmocka_unit_test(a_posture_in_an_obstacle_is_approached_without_contact_or_chatter),
      cmocka_unit_test(a_posture_in_which_the_arm_would_touch_itself_is_said_to_be_so),
      cmocka_unit_test(a_posture_outside_the_limits_counts_as_the_nearest_one_within),
      cmocka_unit_test(a_tool_target_out_of_reach_is_said_to_be_so),
      cmocka_unit_test(a_target_within_reach_is_never_said_to_be_out_of_reach),
      cmocka_unit_test(the_law_of_the_paper_moves_the_tool_to_its_place_in_the_posture),
      cmocka_unit_test(the_same_inputs_give_the_same_commands_and_nothing_allocates),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
