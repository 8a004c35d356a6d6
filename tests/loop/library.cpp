// The controller as a library: the same control cycle behind a header without dependencies.
#include "firmware/library/sidestep.h"
#include "firmware/model/kinematics.h"

#include <chrono>
#include <cmath>
#include <memory>
#include <thread>

#include "tests/support/allocation_count.h"
#include "tests/support/check.h"
#include "tests/support/closed_loop.h"
#include "tests/support/lwa3.h"
#include "tests/support/scratch.h"

using namespace sidestep;

namespace {

const char kConfig[] = "firmware/config/lwa3.yaml";

/// A closed loop of the library and an ideal arm. Public members may be changed between two cycles.
struct Loop {
  explicit Loop(Controller::Foresight foresight = Controller::Foresight::kWithinStep) : controller(kConfig, foresight) {
    const JointVector start_rad = test::at_home("sidestep").arm.position_rad;
    std::copy(start_rad.begin(), start_rad.end(), arm.position_rad.begin());
    target.position_m = {-0.328, 0.15, 0.8};
    sphere.size_m = {0.05, 0.0, 0.0};
    sphere.position_m = {0.6, 0.6, 0.6};
  }

  void cycle() {
    now_s += controller.period_s();
    if (sends_obstacles) controller.set_obstacles(&sphere, 1, now_s);
    controller.set_target(target, now_s);
    last = controller.step(arm, now_s);
    for (size_t i = 0; i < 7; ++i) {
      arm.velocity_radps[i] = last.commanding ? last.velocity_radps[i] : 0.0;
      arm.position_rad[i] += arm.velocity_radps[i] * controller.period_s();
    }
  }
  void run(double duration_s) {
    for (double end_s = now_s + duration_s; now_s < end_s;) cycle();
  }
  bool reports(const char* text) const { return std::string(last.message).find(text) != std::string::npos; }

  Controller controller;
  Controller::ArmState arm;
  Controller::Target target;
  Controller::Obstacle sphere;
  Controller::Result last;
  double now_s = 0.0;
  bool sends_obstacles = true;
};

void the_library_commands_the_same_as_step(void**) {
  Loop loop(Controller::Foresight::kOff);
  test::ClosedLoop same = test::at_home("sidestep");
  same.sends_target = true;
  same.add_sphere({0.6, 0.6, 0.6}, {0, 0, 0}).id = 0;
  for (int k = 0; k < 300; ++k) {
    loop.cycle();
    same.cycle();
    for (int i = 0; i < 7; ++i)
      check(loop.last.velocity_radps[static_cast<size_t>(i)] == same.last.command.velocity_radps[i],
            "cycle %d, joint %d: %.17g, step() commands %.17g", k, i, loop.last.velocity_radps[static_cast<size_t>(i)],
            same.last.command.velocity_radps[i]);
  }
  assert_int_equal(static_cast<int>(loop.last.mode), static_cast<int>(Controller::Mode::kTrack));
  check(loop.last.target_distance_m < 0.01, "%g m from the target", loop.last.target_distance_m);
}

/// In front of the box the arm gets stuck without a guide. The cycles wait for the thread, up to a minute.
void the_arm_arrives_behind_a_box_only_with_foresight_on_a_thread(void**) {
  Loop with(Controller::Foresight::kOnThread), without(Controller::Foresight::kOff);
  for (Loop* loop : {&with, &without}) {
    loop->target.position_m = {0.62, 0.0, 0.62};
    loop->sphere.shape = Controller::Shape::kBox;
    loop->sphere.position_m = {0.32, 0.0, 0.6};
    loop->sphere.size_m = {0.14, 0.6, 0.4};
  }
  without.run(10.0);
  check(without.last.target_distance_m > 0.1, "%g m from the target", without.last.target_distance_m);
  const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(1);
  bool guided = false;
  do {
    with.cycle();
    guided |= with.last.guided;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  } while (!(with.last.target_distance_m < 0.01) && std::chrono::steady_clock::now() < end);
  check(guided && with.last.target_distance_m < 0.01, "%s, %g m from the target", guided ? "guided" : "not guided",
        with.last.target_distance_m);
}

void an_arm_is_paused_resumed_and_slowed(void**) {
  Loop loop;
  loop.run(1.0);
  assert_true(loop.controller.set_control({true, 1.0}, loop.now_s));
  loop.run(0.5);
  assert_true(loop.last.mode == Controller::Mode::kHold && loop.reports("paused"));
  check_near(loop.last.speed_scale, 0.0, 0.0);
  assert_true(loop.controller.set_control({false, 0.5}, loop.now_s));
  loop.run(2.0);
  assert_true(loop.last.mode == Controller::Mode::kTrack);
  check_near(loop.last.speed_scale, 0.5, 0.0);
  check(loop.last.target_distance_m < 0.01, "%g m from the target", loop.last.target_distance_m);
  for (const double scale : {-0.1, 1.1, std::nan("")}) assert_false(loop.controller.set_control({false, scale}, 9.0));
}

void the_arm_keeps_clear_of_all_three_shapes(void**) {
  for (const auto shape : {Controller::Shape::kSphere, Controller::Shape::kCapsule, Controller::Shape::kBox}) {
    Loop loop;
    loop.sphere.shape = shape;
    loop.sphere.position_m = {loop.target.position_m[0], loop.target.position_m[1], loop.target.position_m[2]};
    loop.sphere.size_m = {0.06, 0.06, 0.06};
    double least_m = 1.0;
    for (int k = 0; k < 300; ++k) {
      loop.cycle();
      if (loop.last.commanding) least_m = std::min(least_m, loop.last.clearance_m);
    }
    check(least_m > 0.003 && least_m < 0.1, "shape %d: least clearance %g m", static_cast<int>(shape), least_m);
  }
}

/// A target inside the obstacle: the arm stops where it must.
void a_person_at_rest_is_kept_farther_away_than_a_thing(void**) {
  const auto least_clearance_m = [](bool is_person) {
    Loop loop;
    loop.sphere.position_m = {loop.target.position_m[0], loop.target.position_m[1], loop.target.position_m[2]};
    loop.sphere.is_person = is_person;
    loop.run(3.0);
    return loop.last.clearance_m;
  };
  const double thing_m = least_clearance_m(false), person_m = least_clearance_m(true);
  check(thing_m > 0.003 && thing_m < 0.012 && person_m > 0.018, "%g m and %g m", thing_m, person_m);
}

/// The target is the centre of a sphere. What the tool holds reaches 0.1 m farther than the tool.
void what_is_held_is_kept_clear_and_what_is_allowed_may_be_touched(void**) {
  const auto target_distance_m = [](bool holds, bool allows) {
    Loop loop;
    loop.sphere.id = 3;
    loop.sphere.position_m = {loop.target.position_m[0], loop.target.position_m[1], loop.target.position_m[2]};
    Controller::Obstacle held;
    held.id = 8;
    held.size_m = {0.1, 0, 0};
    assert_true(loop.controller.set_attachments(&held, holds ? 1 : 0, &loop.sphere.id, allows ? 1 : 0, 0.0));
    loop.run(3.0);
    return loop.last.target_distance_m;
  };
  const double empty_m = target_distance_m(false, false), holding_m = target_distance_m(true, false);
  check(empty_m > 0.05 && holding_m > empty_m + 0.03, "%g m empty, %g m holding", empty_m, holding_m);
  const double allowed_m = target_distance_m(true, true);
  check(allowed_m < empty_m - 0.02, "%g m where contact is allowed, %g m else", allowed_m, empty_m);
}

void implausible_attachments_are_rejected(void**) {
  Loop loop;
  Controller::Obstacle held[17];
  for (Controller::Obstacle& shape : held) shape.size_m = {0.01, 0, 0};
  assert_true(loop.controller.set_attachments(held, 16, nullptr, 0, 0.0));
  assert_false(loop.controller.set_attachments(held, 17, nullptr, 0, 0.0));
  assert_false(loop.controller.set_attachments(held, -1, nullptr, 0, 0.0));
  assert_false(loop.controller.set_attachments(nullptr, 0, nullptr, 65, 0.0));
  held[0].position_m[2] = NAN;
  assert_false(loop.controller.set_attachments(held, 1, nullptr, 0, 0.0));
}

void a_pose_is_tracked(void**) {
  Loop loop;
  loop.target.tracks_orientation = true;
  const JointVector there_rad = test::home_rad() + JointVector::Constant(7, 0.2);
  const LinkPoses there = forward_kinematics(test::lwa3(), there_rad);
  const Quaternion turn(there.tool_rotation);
  std::copy_n(there.tool_position.data(), 3, loop.target.position_m.begin());
  loop.target.orientation = {turn.w(), turn.x(), turn.y(), turn.z()};
  loop.run(4.0);
  const JointVector q_rad = Eigen::Map<const JointVector>(loop.arm.position_rad.data(), 7);
  const Matrix3 rotated = forward_kinematics(test::lwa3(), q_rad).tool_rotation;
  const double off_rad = Quaternion(rotated).angularDistance(turn);
  check(off_rad < 1e-2 && loop.last.target_distance_m < 1e-3, "%g rad, %g m", off_rad, loop.last.target_distance_m);
}

void the_newest_of_posture_and_target_is_followed(void**) {
  Loop loop;
  loop.run(1.0);
  Controller::Joints goal_rad = loop.arm.position_rad;
  for (size_t i = 0; i < 7; ++i) goal_rad[i] += 0.1;
  const auto cycle_to_posture = [&] {
    loop.now_s += loop.controller.period_s();
    loop.controller.set_obstacles(&loop.sphere, 1, loop.now_s);
    loop.controller.set_target(loop.target, loop.now_s);
    assert_true(loop.controller.set_joint_target(goal_rad, loop.now_s));
    loop.last = loop.controller.step(loop.arm, loop.now_s);
    for (size_t i = 0; i < 7; ++i) loop.arm.position_rad[i] += loop.last.velocity_radps[i] * loop.controller.period_s();
    loop.arm.velocity_radps = loop.last.velocity_radps;
  };
  for (int k = 0; k < 300; ++k) cycle_to_posture();
  for (size_t i = 0; i < 7; ++i) check_near(loop.arm.position_rad[i], goal_rad[i], 1e-4);
  check_near(loop.last.target_distance_m, 0.0, 1e-4);
  goal_rad[3] = NAN;
  assert_false(loop.controller.set_joint_target(goal_rad, loop.now_s));
  loop.run(2.0);
  check(loop.last.target_distance_m < 0.01, "%g m from the target", loop.last.target_distance_m);
}

void invalid_inputs_are_rejected_and_the_last_valid_ones_are_used(void**) {
  Loop loop;
  loop.run(1.0);
  Controller::Target target = loop.target;
  target.position_m[1] = NAN;
  assert_false(loop.controller.set_target(target, loop.now_s));
  target = loop.target;
  target.tracks_orientation = true;
  target.orientation = {0, 0, 0, 0};
  assert_false(loop.controller.set_target(target, loop.now_s));
  Controller::Obstacle box = loop.sphere;
  box.shape = Controller::Shape::kBox;
  box.size_m = {1.0, -1.0, 1.0};
  assert_false(loop.controller.set_obstacles(&box, 1, loop.now_s));
  assert_false(loop.controller.set_obstacles(&loop.sphere, -1, loop.now_s));
  assert_false(loop.controller.set_obstacles(&loop.sphere, Controller::kMostObstacles + 1, loop.now_s));
  assert_true(loop.controller.set_obstacles(nullptr, 0, loop.now_s));
  loop.run(1.0);
  check(loop.last.target_distance_m < 0.01, "%g m from the target", loop.last.target_distance_m);
}

void a_configuration_with_neighbours_is_rejected(void**) {
  const std::string text = test::replaced(test::text_of(kConfig), "listen: []", "listen: [LINKS_2]");
  const std::string file = test::scratch_file("neighbours.yaml", text);
  const std::string message = test::message_of([&] { Controller(file, Controller::Foresight::kOff); });
  check(test::one_line_with(message, {file.c_str(), "neighbours.listen"}), "'%s'", message.c_str());
}

void without_obstacle_sets_the_controller_brakes_and_reports_it(void**) {
  Loop loop;
  loop.run(0.8);
  loop.sends_obstacles = false;
  loop.run(0.5);
  assert_int_equal(static_cast<int>(loop.last.mode), static_cast<int>(Controller::Mode::kBrake));
  check(loop.reports("obstacles"), "the message is '%s'", loop.last.message);
}

void one_step_without_arm_state_is_bridged_and_many_are_a_fault(void**) {
  Loop loop;
  loop.run(0.7);
  loop.last = loop.controller.step(loop.now_s += 0.01);
  assert_int_equal(static_cast<int>(loop.last.mode), static_cast<int>(Controller::Mode::kTrack));
  for (int k = 0; k < 20; ++k) {
    loop.controller.set_obstacles(&loop.sphere, 1, loop.now_s);
    loop.last = loop.controller.step(loop.now_s += 0.01);
  }
  assert_int_equal(static_cast<int>(loop.last.mode), static_cast<int>(Controller::Mode::kFault));
}

void stop_brakes_to_rest(void**) {
  Loop loop;
  loop.run(0.8);
  assert_true(loop.arm.velocity_radps != Controller::Joints{});
  loop.controller.stop();
  loop.run(1.5);
  assert_true(loop.arm.velocity_radps == Controller::Joints{});
}

void only_the_constructor_allocates(void**) {
  Loop loop;
  loop.run(0.7);
  const long before = test::allocation_count();
  loop.run(1.0);
  assert_int_equal(test::allocation_count() - before, 0);
}

void the_message_names_a_missing_configuration(void**) {
  const std::string message = test::message_of([] { Controller controller("no/such/file.yaml"); });
  check(message.find("no/such/file.yaml") != std::string::npos, "the message is '%s'", message.c_str());
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(the_library_commands_the_same_as_step),
      cmocka_unit_test(the_arm_arrives_behind_a_box_only_with_foresight_on_a_thread),
      cmocka_unit_test(an_arm_is_paused_resumed_and_slowed),
      cmocka_unit_test(the_arm_keeps_clear_of_all_three_shapes),
      cmocka_unit_test(a_person_at_rest_is_kept_farther_away_than_a_thing),
      cmocka_unit_test(what_is_held_is_kept_clear_and_what_is_allowed_may_be_touched),
      cmocka_unit_test(implausible_attachments_are_rejected),
      cmocka_unit_test(a_pose_is_tracked),
      cmocka_unit_test(the_newest_of_posture_and_target_is_followed),
      cmocka_unit_test(invalid_inputs_are_rejected_and_the_last_valid_ones_are_used),
      cmocka_unit_test(a_configuration_with_neighbours_is_rejected),
      cmocka_unit_test(without_obstacle_sets_the_controller_brakes_and_reports_it),
      cmocka_unit_test(one_step_without_arm_state_is_bridged_and_many_are_a_fault),
      cmocka_unit_test(stop_brakes_to_rest),
      cmocka_unit_test(only_the_constructor_allocates),
      cmocka_unit_test(the_message_names_a_missing_configuration),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
