// The controller as a library: the same cycle as everywhere, behind a header that shows nothing of it.
#include "firmware/library/sidestep.h"

#include <cmath>
#include <memory>

#include "tests/support/allocation_count.h"
#include "tests/support/check.h"
#include "tests/support/closed_loop.h"
#include "tests/support/lwa3.h"
#include "tests/support/scratch.h"

using namespace sidestep;

namespace {

const char kConfig[] = "firmware/config/lwa3.yaml";

/// The library moves an ideal arm; everything public may be changed between two cycles.
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
    if (obstacles_speak) controller.set_obstacles(&sphere, 1, now_s);
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
  bool says(const char* words) const { return std::string(last.message).find(words) != std::string::npos; }

  Controller controller;
  Controller::ArmState arm;
  Controller::Target target;
  Controller::Obstacle sphere;
  Controller::Result last;
  double now_s = 0.0;
  bool obstacles_speak = true;
};

void it_commands_what_the_cycle_commands(void**) {
  Loop loop(Controller::Foresight::kOff);
  test::ClosedLoop same = test::at_home("sidestep");
  same.target_speaks = true;
  same.add_sphere({0.6, 0.6, 0.6}, {0, 0, 0}).id = 0;
  for (int k = 0; k < 300; ++k) {
    loop.cycle();
    same.cycle();
    for (int i = 0; i < 7; ++i)
      check(loop.last.velocity_radps[static_cast<size_t>(i)] == same.last.command.velocity_radps[i],
            "cycle %d, joint %d: %.17g, the cycle has %.17g", k, i, loop.last.velocity_radps[static_cast<size_t>(i)],
            same.last.command.velocity_radps[i]);
  }
  assert_int_equal(static_cast<int>(loop.last.mode), static_cast<int>(Controller::Mode::kTrack));
  check(loop.last.target_distance_m < 0.01, "%g m from the target", loop.last.target_distance_m);
}

void foresight_on_a_thread_of_its_own_does_no_harm(void**) {
  Loop loop(Controller::Foresight::kOnThread);
  loop.run(2.0);
  check(loop.last.target_distance_m < 0.01, "%g m from the target", loop.last.target_distance_m);
}

void all_three_shapes_keep_their_distance(void**) {
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
    check(least_m > 0.01 && least_m < 0.1, "shape %d: least clearance %g m", static_cast<int>(shape), least_m);
  }
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

void what_cannot_be_true_is_refused_and_the_last_counts(void**) {
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

void neighbours_that_it_could_not_hear_are_refused(void**) {
  const std::string text = test::replaced(test::text_of(kConfig), "listen: []", "listen: [LINKS_2]");
  const std::string file = test::scratch_file("neighbours.yaml", text);
  const std::string said = test::message_of([&] { Controller(file, Controller::Foresight::kOff); });
  check(test::one_line_with(said, {file.c_str(), "neighbours.listen"}), "'%s'", said.c_str());
}

void without_obstacle_sets_it_brakes_and_says_so(void**) {
  Loop loop;
  loop.run(0.8);
  loop.obstacles_speak = false;
  loop.run(0.5);
  assert_int_equal(static_cast<int>(loop.last.mode), static_cast<int>(Controller::Mode::kBrake));
  check(loop.says("obstacles"), "it says '%s'", loop.last.message);
}

void a_step_without_an_arm_state_is_bridged_and_many_are_a_fault(void**) {
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

void asked_to_stop_it_comes_to_rest(void**) {
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

void a_bad_configuration_is_named(void**) {
  const std::string words = test::message_of([] { Controller controller("no/such/file.yaml"); });
  check(words.find("no/such/file.yaml") != std::string::npos, "it says '%s'", words.c_str());
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(it_commands_what_the_cycle_commands),
      cmocka_unit_test(foresight_on_a_thread_of_its_own_does_no_harm),
      cmocka_unit_test(all_three_shapes_keep_their_distance),
      cmocka_unit_test(a_pose_is_tracked),
      cmocka_unit_test(what_cannot_be_true_is_refused_and_the_last_counts),
      cmocka_unit_test(neighbours_that_it_could_not_hear_are_refused),
      cmocka_unit_test(without_obstacle_sets_it_brakes_and_says_so),
      cmocka_unit_test(a_step_without_an_arm_state_is_bridged_and_many_are_a_fault),
      cmocka_unit_test(asked_to_stop_it_comes_to_rest),
      cmocka_unit_test(only_the_constructor_allocates),
      cmocka_unit_test(a_bad_configuration_is_named),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
