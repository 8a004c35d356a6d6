#include "firmware/model/load/load_arm.h"
#include "tests/support/check.h"
#include "tests/support/scratch.h"

using namespace sidestep;
using test::message_of;
using test::one_line_with;
using test::replaced;
using test::scratch_file;
using test::text_of;

namespace {

const char kJoint4[] = R"(<limit lower="-1.97" upper="1.97" velocity="2.0" effort="176"/>)";

std::string lwa3() {
  return text_of("urdf/lwa3.urdf");
}

/// A URDF of a number of joints about z, one above the other.
std::string tower(int joints) {
  std::string text =
      R"(<robot name="tower"><link name="l0"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>)";
  for (int i = 1; i <= joints; ++i) {
    const std::string n = std::to_string(i);
    text += "<link name='l" + n + "'/><joint name='j" + n + "' type='revolute'><parent link='l" +
            std::to_string(i - 1) + "'/><child link='l" + n + "'/><origin xyz='0 0 0.1'/><axis xyz='0 0 1'/>" +
            "<limit lower='-1' upper='1' velocity='1' effort='1'/></joint>";
  }
  return text + "</robot>";
}

/// The error message for a URDF; empty if it loads and its limits are valid.
std::string error_of(const std::string& file, const std::string& base = "base_link", const std::string& tip = "tool") {
  return message_of([&] { check_limits(load_arm(file, base, tip)); });
}

void a_bad_urdf_is_refused_with_one_line_that_names_file_and_culprit(void**) {
  const std::string good = lwa3();
  const struct {
    const char* name;
    const char* from;
    const char* to;
    const char* culprit;
  } cases[] = {
      {"xacro", "</robot>", "<xacro:macro name='hand'/></robot>", "is a xacro file"},
      {"planar", R"(name="joint_3" type="revolute")", R"(name="joint_3" type="planar")", "joint_3"},
      {"floating", R"(name="joint_3" type="revolute")", R"(name="joint_3" type="floating")", "joint_3"},
      {"no_type", R"(name="joint_3" type="revolute")", R"(name="joint_3" type="hinge")", ""},
      {"no_limit", kJoint4, "", ""},
      {"zero_axis", R"(<axis xyz="0 0 1"/>)", R"(<axis xyz="0 0 0"/>)", "joint_1"},
      {"nan_axis", R"(<axis xyz="0 0 1"/>)", R"(<axis xyz="0 nan 1"/>)", ""},
      {"nan_origin", R"(<origin xyz="0 0.328 0")", R"(<origin xyz="0 nan 0")", ""},
      {"infinite_origin", R"(<origin xyz="0 0.328 0")", R"(<origin xyz="0 inf 0")", ""},
      {"word_for_origin", R"(<origin xyz="0 0.328 0")", R"(<origin xyz="0 far 0")", ""},
      {"nan_shape_origin", R"(<origin xyz="0 0 -0.164")", R"(<origin xyz="0 0 nan")", ""},
      {"word_for_radius", R"(<cylinder radius="0.05" length="0.328"/>)", R"(<cylinder radius="thin" length="0.328"/>)",
       ""},
      {"unknown_shape", R"(<cylinder radius="0.05" length="0.328"/>)", R"(<cone radius="0.05" length="0.328"/>)", ""},
      {"mesh", R"(<cylinder radius="0.05" length="0.328"/>)", R"(<mesh filename="arm.stl"/>)", "upper_arm_link"},
      {"zero_radius", R"(<cylinder radius="0.05" length="0.328"/>)", R"(<cylinder radius="0" length="0.328"/>)",
       "upper_arm_link"},
      {"negative_length", R"(<cylinder radius="0.05" length="0.328"/>)", R"(<cylinder radius="0.05" length="-1"/>)",
       "upper_arm_link"},
      {"zero_sphere", R"(<sphere radius="0.05"/>)", R"(<sphere radius="0.0"/>)", "base_link"},
      {"flat_box", R"(<sphere radius="0.05"/>)", R"(<box size="0.1 0 0.1"/>)", "base_link"},
      {"no_child", R"(<child link="forearm_link"/>)", R"(<child link="nobody"/>)", ""},
      {"two_parents", R"(<child link="wrist_link"/>)", R"(<child link="hand_link"/>)", ""},
      {"not_xml", "<robot", "robot", ""},
      {"other_xml", "<robot name=\"lwa3\">", "<html>", ""},
  };
  int wrong = 0;
  for (const auto& bad : cases) {
    const std::string file = scratch_file(std::string(bad.name) + ".urdf", replaced(good, bad.from, bad.to));
    const std::string message = error_of(file);
    if (one_line_with(message, {file, bad.culprit})) continue;
    print_error("%s -> '%s'\n", bad.name, message.c_str());
    ++wrong;
  }
  assert_int_equal(wrong, 0);
}

void a_wrong_chain_is_refused_with_one_line(void**) {
  const std::string file = "urdf/lwa3.urdf";
  check(one_line_with(error_of("urdf/none.urdf"), {"urdf/none.urdf"}), "missing file");
  check(one_line_with(error_of("urdf"), {"urdf: cannot be read"}), "a folder");
  check(one_line_with(error_of(file, "nowhere"), {file, "nowhere"}), "missing base");
  check(one_line_with(error_of(file, "base_link", "nowhere"), {file, "nowhere"}), "missing tip");
  check(one_line_with(error_of(file, "tool", "base_link"), {file, "tool", "base_link"}), "base below tip");
  check(one_line_with(error_of(file, "forearm_link"), {file, "forearm_link"}), "too few joints");
  check(one_line_with(error_of(file, "tool", "tool"), {file, "tool"}), "base is tip");
  check(one_line_with(error_of(scratch_file("empty.urdf", "")), {"empty.urdf"}), "empty file");
  check(one_line_with(error_of(scratch_file("zeros.urdf", std::string(4096, '\0'))), {"zeros.urdf"}), "zeros");
  check(one_line_with(error_of(scratch_file("no_link.urdf", "<robot name='x'/>")), {"no_link.urdf"}), "no link");
}

void a_chain_has_6_to_10_joints(void**) {
  for (int joints = 0; joints <= 12; ++joints) {
    const std::string tip = "l" + std::to_string(joints), file = scratch_file("tower.urdf", tower(joints));
    const std::string message = error_of(file, "l0", tip);
    const bool right = joints >= kMinJoints && joints <= kMaxJoints;
    check(right ? message.empty() : one_line_with(message, {file, "joints"}), "%d joints: '%s'", joints,
          message.c_str());
  }
}

void an_arm_without_collision_geometry_is_refused(void**) {
  const std::string baseline =
      replaced(tower(7), "<collision><geometry><sphere radius=\"0.1\"/></geometry></collision>", "");
  check(one_line_with(error_of(scratch_file("bare.urdf", baseline), "l0", "l7"), {"bare.urdf", "collision"}),
        "no shape");
}

void at_most_64_shapes_count_after_those_inside_others_are_removed(void**) {
  const auto with_spheres = [](int count, double apart_m) {
    std::string shapes;
    for (int i = 0; i < count; ++i)
      shapes += "<collision><origin xyz='" + std::to_string(apart_m * i) +
                " 0 0'/><geometry><sphere radius='0.1'/></geometry></collision>";
    return scratch_file("spheres.urdf",
                        replaced(tower(6), "<link name='l6'/>", "<link name='l6'>" + shapes + "</link>"));
  };
  assert_string_equal(error_of(with_spheres(kMaxLinkShapes - 1, 0.3), "l0", "l6").c_str(), "");
  check(one_line_with(error_of(with_spheres(kMaxLinkShapes, 0.3), "l0", "l6"),
                      {"spheres.urdf", std::to_string(kMaxLinkShapes + 1)}),
        "one too many");
  // 200 equal spheres are reduced to one.
  assert_int_equal(load_arm(with_spheres(200, 0.0), "l0", "l6").shapes.size(), 2);
}

void wrong_limits_are_refused(void**) {
  const struct {
    const char* limit;
    const char* word;
  } cases[] = {
      {R"(<limit lower="1.97" upper="-1.97" velocity="2.0" effort="176"/>)", "lower"},
      {R"(<limit lower="1" upper="1" velocity="2.0" effort="176"/>)", "lower"},
      {R"(<limit lower="-1.97" upper="1.97" velocity="0" effort="176"/>)", "velocity"},
      {R"(<limit lower="-1.97" upper="1.97" velocity="-2" effort="176"/>)", "velocity"},
  };
  for (const auto& bad : cases) {
    const std::string text = replaced(replaced(lwa3(), R"(upper="1.97")", R"(upper="1.971")"), kJoint4, bad.limit);
    const std::string message = error_of(scratch_file("limits.urdf", text));
    check(one_line_with(message, {"joint_4", bad.word}), "%s: '%s'", bad.limit, message.c_str());
  }
}

void an_endless_joint_needs_a_velocity_limit(void**) {
  const std::string text = replaced(replaced(lwa3(), kJoint4, ""), R"(name="joint_4" type="revolute")",
                                    R"(name="joint_4" type="continuous")");
  const std::string file = scratch_file(
      "endless.urdf", replaced(text, R"(name="joint_2" type="revolute")", R"(name="joint_2" type="continuous")"));
  const std::string message = error_of(file);
  check(one_line_with(message, {"velocity"}), "'%s'", message.c_str());
}

void a_urdf_of_too_many_tags_or_bytes_is_refused(void**) {
  std::string nested = "<robot name='x'>";
  for (int i = 0; i < 500000; ++i) nested += "<a>";
  check(one_line_with(error_of(scratch_file("nested.urdf", nested)), {"nested.urdf", "tags"}), "nested");
  check(one_line_with(error_of(scratch_file("tower.urdf", tower(50000)), "l0", "l6"), {"tower.urdf", "tags"}),
        "a tower");
  check(one_line_with(error_of("/dev/zero"), {"/dev/zero", "larger"}), "endless");
}

void a_truncated_urdf_never_crashes(void**) {
  const std::string good = lwa3();
  int loaded = 0;
  for (size_t length = 0; length < good.size(); length += 50) {
    const std::string message = error_of(scratch_file("truncated.urdf", good.substr(0, length)));
    check(message.empty() || one_line_with(message, {"truncated.urdf"}), "%zu bytes: '%s'", length, message.c_str());
    loaded += message.empty();
  }
  assert_int_equal(loaded, 0);
}

void limits_in_degrees_are_warned_of(void**) {
  const std::string degrees =
      replaced(lwa3(), kJoint4, R"(<limit lower="-113" upper="113" velocity="2.0" effort="176"/>)");
  const Arm arm = load_arm(scratch_file("degrees.urdf", degrees), "base_link", "tool");
  assert_int_equal(arm.warnings.size(), 1);
  check(one_line_with(arm.warnings[0], {"'joint_4'", "degrees"}), "%s", arm.warnings[0].c_str());
  assert_true(load_arm("urdf/lwa3.urdf", "base_link", "tool").warnings.empty());
}

void a_urdf_that_only_mentions_xacro_in_a_comment_is_read(void**) {
  const std::string text = replaced(lwa3(), "</robot>", "<!-- made from <xacro:macro> --></robot>");
  assert_string_equal(error_of(scratch_file("from_xacro.urdf", text)).c_str(), "");
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(limits_in_degrees_are_warned_of),
      cmocka_unit_test(a_urdf_that_only_mentions_xacro_in_a_comment_is_read),
      cmocka_unit_test(a_bad_urdf_is_refused_with_one_line_that_names_file_and_culprit),
      cmocka_unit_test(a_wrong_chain_is_refused_with_one_line),
      cmocka_unit_test(a_chain_has_6_to_10_joints),
      cmocka_unit_test(an_arm_without_collision_geometry_is_refused),
      cmocka_unit_test(at_most_64_shapes_count_after_those_inside_others_are_removed),
      cmocka_unit_test(wrong_limits_are_refused),
      cmocka_unit_test(an_endless_joint_needs_a_velocity_limit),
      cmocka_unit_test(a_urdf_of_too_many_tags_or_bytes_is_refused),
      cmocka_unit_test(a_truncated_urdf_never_crashes),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
