#include "host/sim/arm.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "firmware/model/kinematics.h"
#include "firmware/model/load/load_arm.h"
#include "tests/support/check.h"
#include "tests/support/random.h"

using namespace sidestep::sim;
using sidestep::test::message_of;
using sidestep::test::one_line_with;

namespace {

Arm load(const std::string& urdf, const std::string& base = "base", const std::string& tip = "tip") {
  const auto file = std::filesystem::temp_directory_path() / ("sim_arm." + std::to_string(getpid()) + ".urdf");
  std::ofstream(file) << urdf;
  struct Cleanup {
    std::filesystem::path file;
    ~Cleanup() { std::filesystem::remove(file); }
  } const cleanup{file};
  return Arm(file.string(), base, tip);
}

const std::string kBall = R"(<collision><geometry><sphere radius="0.1"/></geometry></collision>)";

std::string link(const std::string& name, const std::string& content = kBall) {
  return "<link name=\"" + name + "\">" + content + "</link>";
}

std::string joint(const std::string& parent, const std::string& child, const std::string& type = "revolute",
                  const std::string& axis = "0 0 1") {
  return "<joint name=\"to_" + child + "\" type=\"" + type + "\"><parent link=\"" + parent + "\"/><child link=\"" +
         child + "\"/><origin xyz=\"1 0 0\"/><axis xyz=\"" + axis +
         "\"/><limit lower=\"-1\" upper=\"1\" velocity=\"1\" effort=\"1\"/></joint>";
}

std::string robot(const std::string& content) {
  return "<robot name=\"r\">" + content + "</robot>";
}

const ArmPart& part_of(const Arm& arm, const std::string& link_name) {
  for (const ArmPart& part : arm.parts()) {
    if (part.link == link_name) return part;
  }
  throw std::runtime_error("no part of " + link_name);
}

void links_below_the_base_and_links_fixed_to_the_base_are_parts(void**) {
  Arm arm = load(robot(link("world") + link("cart") + link("base") + link("arm") + link("lamp") + link("finger") +
                       link("tip") + link("flag") + link("door") + joint("world", "cart", "prismatic") +
                       joint("cart", "base", "fixed") + joint("cart", "flag", "fixed") + joint("cart", "door") +
                       joint("base", "arm") + joint("arm", "lamp", "fixed") + joint("arm", "finger") +
                       joint("arm", "tip", "fixed")));
  assert_int_equal(arm.joints(), 1);
  assert_int_equal(arm.parts().size(), 7);  // not world and not door
  assert_false(part_of(arm, "cart").moving);
  assert_false(part_of(arm, "flag").moving);
  assert_true(part_of(arm, "lamp").moving);
  assert_true(part_of(arm, "finger").moving);
  arm.place(JointVector::Constant(1, M_PI / 2));
  check_near(part_of(arm, "cart").base_from_part.translation(), Eigen::Vector3d(-1, 0, 0), 1e-15);
  check_near(part_of(arm, "flag").base_from_part.translation(), Eigen::Vector3d(0, 0, 0), 1e-15);
  check_near(part_of(arm, "finger").base_from_part.translation(), Eigen::Vector3d(1, 1, 0), 1e-15);
  check_near(arm.base_from_tool().translation(), Eigen::Vector3d(1, 1, 0), 1e-15);
}

void revolute_continuous_and_prismatic_joints_move_the_tool(void**) {
  Arm arm = load(robot(link("base") + link("a") + link("b") + link("tip") + joint("base", "a", "continuous") +
                       joint("a", "b", "prismatic", "0 1 0") + joint("b", "tip", "revolute", "0 0 -1")));
  assert_int_equal(arm.joints(), 3);
  JointVector q_rad(3);
  q_rad << M_PI / 2, 0.5, M_PI / 2;
  arm.place(q_rad);
  // 1 m to the first joint, a quarter turn to the left, 1 m to the slide, 0.5 m to its left, 1 m to the last joint.
  check_near(arm.base_from_tool().translation(), Eigen::Vector3d(1 - 0.5, 2, 0), 1e-15);
  check_near(arm.base_from_tool().linear(), Eigen::Matrix3d::Identity(), 1e-15);
}

/// The kinematics of simulator and controller are independent of each other.
void links_behind_other_joints_are_where_the_controller_has_them(void**) {
  const char* urdf = "tests/data/lift_arm.urdf";
  const std::map<std::string, double> positions = {
      {"lift", 0.35}, {"left_1", 0.4}, {"left_2", -1.0}, {"left_finger_joint", 0.03}};
  Arm arm(urdf, "carriage", "tool", {}, positions);
  const sidestep::Arm controllers = sidestep::load_arm(urdf, "carriage", "tool", {}, positions);
  sidestep::test::Random random(1);
  for (int trial = 0; trial < 20; ++trial) {
    const JointVector q_rad = random.configuration(controllers);
    arm.place(q_rad);
    const sidestep::LinkPoses poses = sidestep::forward_kinematics(controllers, q_rad);
    for (const char* link : {"mast", "left_upper", "left_lower", "hand", "left_finger", "right_finger"})
      for (const sidestep::LinkShape& shape : controllers.shapes)
        if (shape.link == link)
          check_near_because(part_of(arm, link).base_from_part.translation(), transformed(poses, shape).centre(), 1e-9,
                             "link '%s'", link);
  }
  assert_string_equal(message_of([&] { part_of(arm, "head"); }).c_str(), "no part of head");
}

void bad_arms_are_refused_with_one_line_that_names_the_file(void**) {
  const std::string two = link("base") + link("tip");
  const struct {
    std::string urdf, complaint;
  } cases[] = {
      {"", "not a valid URDF"},
      {"no xml", "not a valid URDF"},
      {"<robot name=\"r\"/>", "not a valid URDF"},
      {"<robot version=\"x\" name=\"r\">" + two + joint("base", "tip") + "</robot>", "not a valid URDF"},
      {robot(two), "not a valid URDF"},  // two roots
      {robot(two + joint("base", "tip") + joint("tip", "base")), "not a valid URDF"},
      {robot(link("base") + link("other") + joint("base", "other")), "no link 'tip'"},
      {robot(link("world") + two + joint("world", "base") + joint("world", "tip")), "'tip' is not below link 'base'"},
      {robot(two + joint("base", "tip", "fixed")), "no joint between"},
      {robot(two + joint("base", "tip", "floating")), "joint 'to_tip' is neither"},
      {robot(two + joint("base", "tip", "revolute", "0 0 0")), "joint 'to_tip': the axis"},
      {robot(two + joint("base", "tip", "revolute", "nan 0 0")), "not a valid URDF: Malformed axis"},
      {robot(link("base") + link("tip", R"(<collision><geometry><mesh filename="a.stl"/></geometry></collision>)") +
             joint("base", "tip")),
       "link 'tip': mesh 'a.stl' is in no folder"},
      {robot(link("base") + link("tip", R"(<collision><geometry><sphere radius="-1"/></geometry></collision>)") +
             joint("base", "tip")),
       "link 'tip': a collision shape has a size"},
      {robot(link("base") + link("tip", R"(<collision><geometry><sphere radius="nan"/></geometry></collision>)") +
             joint("base", "tip")),
       "not a valid URDF: radius"},
      {robot(link("base") + link("tip", R"(<collision><geometry><box size="1 0 1"/></geometry></collision>)") +
             joint("base", "tip")),
       "link 'tip': a collision shape has a size out of range"},
  };
  for (const auto& c : cases) {
    const std::string message = message_of([&] { load(c.urdf); });
    check(one_line_with(message, {".urdf: ", c.complaint}), "%s: %s", c.urdf.c_str(), message.c_str());
  }
  assert_true(one_line_with(message_of([] { Arm("no/such.urdf", "a", "b"); }), {"no/such.urdf: cannot be read"}));
  assert_true(one_line_with(message_of([] { Arm("urdf", "a", "b"); }), {"urdf: "}));
}

void eleven_joints_are_refused(void**) {
  std::string content = link("base");
  std::string parent = "base";
  for (int i = 1; i <= 11; ++i) {
    const std::string child = i == 11 ? "tip" : "l" + std::to_string(i);
    content += link(child) + joint(parent, child);
    parent = child;
  }
  assert_true(one_line_with(message_of([&] { load(robot(content)); }), {"more than 10 joints"}));
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(links_below_the_base_and_links_fixed_to_the_base_are_parts),
      cmocka_unit_test(revolute_continuous_and_prismatic_joints_move_the_tool),
      cmocka_unit_test(links_behind_other_joints_are_where_the_controller_has_them),
      cmocka_unit_test(bad_arms_are_refused_with_one_line_that_names_the_file),
      cmocka_unit_test(eleven_joints_are_refused),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
