// The arm keeps clear of the robot's other arm, whose joints a message reports.

#include "firmware/io/config/config.h"
#include "firmware/model/kinematics.h"
#include "firmware/model/proximity.h"
#include "tests/support/check.h"
#include "tests/support/closed_loop.h"
#include "tests/support/scratch.h"

using namespace sidestep;
using test::ClosedLoop;

namespace {

const Model& two_armed() {
  static const Model model =
      load_config(test::scratch_file("two_armed.yaml",
                                     "robot: {urdf: tests/data/lift_arm.urdf, base: mast, tip: tool, joint_positions: "
                                     "{left_1: 0.0, left_2: -0.1, head_joint: 0.0, left_finger_joint: 0.0}}\n"),
                  {})
          .model;
  return model;
}

/// The tool is at (0.5, 0.3, 0.85), in the way of the left arm when that one swings forward.
JointVector start_rad() {
  JointVector q_rad(8);
  q_rad << 0.06, -0.26, 0.13, 1.02, -0.92, 0.73, -1.43, 0.01;
  return q_rad;
}

size_t index_of(const Arm& arm, const std::string& joint) {
  for (size_t j = 0; j < arm.other_joints.size(); ++j)
    if (arm.other_joints[j].name == joint) return j;
  check(false, "no joint '%s'", joint.c_str());
  return 0;
}

/// The least distance between the two arms, m; both as capsules, where tests/unit/model/load/other_joints finds them.
double between_arms_m(const Arm& arm, const JointVector& q_rad, const OtherJoints& others) {
  const OtherFrames frames = place_other_joints(arm, others);
  const LinkPoses poses = forward_kinematics(arm, q_rad, frames);
  double least_m = HUGE_VAL;
  for (const LinkShape& left : arm.shapes)
    for (const LinkShape& right : arm.shapes)
      if (left.link.rfind("left_", 0) == 0 && left.body == 0 && right.body > 0)
        least_m = std::min(least_m, measure_pair(transformed(poses, right), transformed(poses, left)).distance_m);
  return least_m;
}

struct Figures {
  double least_m = HUGE_VAL;
  std::string violation;
};

/// The left arm swings up through the place of the right one, within its velocity limit, and stays.
Figures swing(bool is_reported) {
  ClosedLoop loop(two_armed(), start_rad());
  const Arm& arm = loop.model.arm;
  const LinkPoses start = forward_kinematics(arm, start_rad());
  loop.sends_target = true;
  loop.target.position_m = start.tool_position;
  loop.sends_others = is_reported;
  const size_t joint = index_of(arm, "left_1"), elbow = index_of(arm, "left_2");
  Figures figures;
  for (int i = 0; i < 500; ++i) {
    const double t_s = std::max(0.0, loop.now_s() - 1.0), rate_radps = t_s > 0.0 && t_s < 2.0 ? 0.7 : 0.0;
    loop.others.position[joint] = -0.7 * std::min(t_s, 2.0);
    loop.others.position[elbow] = -0.1;
    loop.others.velocity[joint] = -rate_radps;
    loop.cycle();
    figures.least_m = std::min(figures.least_m, between_arms_m(arm, loop.arm.position_rad, loop.others));
  }
  figures.violation = loop.commands.violation();
  return figures;
}

void the_arm_gives_way_to_the_other_arm(void**) {
  const Figures unreported = swing(false);
  check(unreported.least_m < 0.0, "the arms do not meet without the message: %g m", unreported.least_m);
  const Figures figures = swing(true);
  print_message("least distance of the two arms: %.1f mm\n", 1e3 * figures.least_m);
  check(figures.least_m > 0.0, "%g m", figures.least_m);
  check(figures.violation.empty(), "%s", figures.violation.c_str());
}

/// The first message shows the other arm elsewhere than the configuration: right at this arm.
void the_first_message_is_bumpless(void**) {
  ClosedLoop loop(two_armed(), start_rad());
  loop.sends_target = true;
  loop.target.position_m = forward_kinematics(loop.model.arm, start_rad()).tool_position;
  loop.run(1.5);
  const Arm& arm = loop.model.arm;
  loop.others.position[index_of(arm, "left_1")] = -1.2;
  loop.sends_others = true;
  const double before_m = between_arms_m(arm, loop.arm.position_rad, loop.others);
  loop.run(3.0);
  test::check_stream(loop);
  const double after_m = between_arms_m(arm, loop.arm.position_rad, loop.others);
  check(before_m < 0.0, "%g m: the left arm is not at this one", before_m);
  check(after_m > 0.0, "%g m", after_m);
}

void an_outdated_message_keeps_the_last_positions(void**) {
  JointVector aside_rad = start_rad();
  aside_rad[1] = -1.2;
  ClosedLoop loop(two_armed(), aside_rad);
  const Arm& arm = loop.model.arm;
  loop.others.position[index_of(arm, "left_1")] = -1.2;
  loop.sends_others = true;
  loop.run(0.1);
  loop.sends_others = false;
  loop.sends_target = true;
  loop.target.position_m = forward_kinematics(arm, start_rad()).tool_position;
  double least_m = HUGE_VAL;
  for (int i = 0; i < 500; ++i) {
    loop.cycle();
    least_m = std::min(least_m, between_arms_m(arm, loop.arm.position_rad, loop.others));
  }
  test::check_stream(loop);
  check(least_m > 0.0 && least_m < 0.1, "%g m", least_m);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(the_arm_gives_way_to_the_other_arm),
      cmocka_unit_test(the_first_message_is_bumpless),
      cmocka_unit_test(an_outdated_message_keeps_the_last_positions),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
