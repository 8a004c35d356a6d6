#include "firmware/io/config/config.h"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <vector>

#include "tests/support/check.h"
#include "tests/support/scratch.h"

using namespace sidestep;
using test::message_of;
using test::one_line_with;
using test::replaced;
using test::scratch_file;
using test::text_of;

namespace {

const char kRobot[] = "robot: {urdf: urdf/lwa3.urdf, base: base_link, tip: tool}\n";

/// Loads a configuration of the LWA3 with additional YAML text.
Config load(const std::string& yaml) {
  return load_config(scratch_file("config.yaml", kRobot + yaml), {});
}

/// One number is in rad and counts for the revolute joints; a list has each joint's own unit.
void one_limit_for_all_joints_leaves_the_prismatic_ones_as_they_are(void**) {
  const std::string robot = "robot: {urdf: tests/data/lift_arm.urdf, base: mast, tip: tool}\n";
  const auto limits_of = [&](const std::string& limits) {
    return load_config(scratch_file("lift.yaml", robot + "limits: {" + limits + "}\n"), {}).model.arm.limits;
  };
  const JointLimits one = limits_of("velocity_radps: 1.5, acceleration_radps2: 5, lower_rad: -1, upper_rad: 1");
  check_near(one.velocity_radps[0], 0.3, 0);
  check_near(one.acceleration_radps2[0], kDefaultAcceleration_mps2, 0);
  check_near(one.lower_rad[0], 0.0, 0);
  check_near(one.upper_rad[0], 0.6, 0);
  check_near(one.velocity_radps[1], 1.5, 0);
  check_near(one.upper_rad[7], 1.0, 0);
  check_near(limits_of("velocity_radps: [0.2, 1, 1, 1, 1, 1, 1, 1]").velocity_radps[0], 0.2, 0);
}

void positions_of_other_joints_are_read_and_the_others_are_warned_of(void**) {
  const auto load_with = [](const std::string& positions) {
    return load_config(scratch_file("others.yaml",
                                    "robot: {urdf: tests/data/lift_arm.urdf, base: mast, tip: tool, "
                                    "joint_positions: {" +
                                        positions + "}}\n"),
                       {});
  };
  const Config config = load_with("left_1: 0.5, left_finger_joint: 0.02");
  assert_int_equal(config.robot.joint_positions.size(), 2);
  const auto has = [&](const char* text) {
    return std::any_of(config.warnings.begin(), config.warnings.end(),
                       [&](const std::string& warning) { return warning.find(text) != std::string::npos; });
  };
  assert_true(has("'head_joint'") && has("'left_2'"));
  assert_false(has("'left_1'") || has("finger"));
  for (const auto& [positions, complaint] : std::vector<std::pair<std::string, std::string>>{
           {"neck: 0.1", "robot.joint_positions.neck: the URDF has no such joint"},
           {"head_joint: 2", "robot.joint_positions.head_joint: is 2, the joint moves from -0.5 to 1.2"},
           {"lift: 0.1", "robot.joint_positions.lift: is a joint of the chain"},
           {"head_joint: up", "robot.joint_positions.head_joint: must be a number"}}) {
    const std::string error = message_of([&, &text = positions] { load_with(text); });
    check(test::one_line_with(error, {"others.yaml", complaint}), "%s", error.c_str());
  }
}

/// 30 rad/s are 7.5 m/s.
void a_limit_that_limits_nothing_is_judged_in_the_unit_of_its_joint(void**) {
  const std::string robot = "robot: {urdf: tests/data/lift_arm.urdf, base: mast, tip: tool}\n";
  const auto warnings_of = [&](const std::string& lift_mps) {
    return load_config(
               scratch_file("lift.yaml", robot + "limits: {velocity_radps: [" + lift_mps + ", 2, 2, 2, 2, 2, 2, 2]}\n"),
               {})
        .warnings;
  };
  const auto has = [](const std::vector<std::string>& warnings, const std::string& text) {
    return std::any_of(warnings.begin(), warnings.end(),
                       [&](const std::string& warning) { return warning.find(text) != std::string::npos; });
  };
  assert_true(has(warnings_of("8"), "'lift' has a velocity limit above 7.5 m/s"));
  assert_false(has(warnings_of("7"), "limits nothing"));
}

struct Key {
  const char* section;
  const char* key;
  double value;
  std::function<double(const Config&)> read;
};

/// The keys that hold one number, with a value that is not the default.
const Key kNumbers[] = {
    {"control", "rate_hz", 250, [](const Config& c) { return c.model.settings.rate_hz; }},
    {"control", "following_error_rad", 0.2, [](const Config& c) { return c.model.settings.following_error_rad; }},
    {"paper", "k_pos_per_s2", 1.5, [](const Config& c) { return c.model.settings.paper.k_pos_per_s2; }},
    {"paper", "k_vel_per_s", 1.5, [](const Config& c) { return c.model.settings.paper.k_vel_per_s; }},
    {"paper", "k_rpos_m2ps2", 1.5, [](const Config& c) { return c.model.settings.paper.k_rpos_m2ps2; }},
    {"paper", "k_rvel_m2ps2", 1.5, [](const Config& c) { return c.model.settings.paper.k_rvel_m2ps2; }},
    {"paper", "rho_0_m", 1.5, [](const Config& c) { return c.model.settings.paper.rho_0_m; }},
    {"paper", "rho_v_m", 1.5, [](const Config& c) { return c.model.settings.paper.rho_v_m; }},
    {"paper", "rho_min_m", 0.5, [](const Config& c) { return c.model.settings.paper.rho_min_m; }},
    {"paper", "v_max_mps", 1.5, [](const Config& c) { return c.model.settings.paper.v_max_mps; }},
    {"paper", "lambda_0", 0.5, [](const Config& c) { return c.model.settings.paper.lambda_0; }},
    {"paper", "sigma_0", 0.5, [](const Config& c) { return c.model.settings.paper.sigma_0; }},
    {"paper", "lambda_n", 0.5, [](const Config& c) { return c.model.settings.paper.lambda_n; }},
    {"paper", "x_m_mps", 1.5, [](const Config& c) { return c.model.settings.paper.x_m_mps; }},
    {"paper", "d_m_m", 1.5, [](const Config& c) { return c.model.settings.paper.d_m_m; }},
    {"paper", "d_1_m", 1.5, [](const Config& c) { return c.model.settings.paper.d_1_m; }},
    {"paper", "d_2_m", 0.15, [](const Config& c) { return c.model.settings.paper.d_2_m; }},
    {"paper", "k_ori_per_s", 1.5, [](const Config& c) { return c.model.settings.paper.k_ori_per_s; }},
    {"timeouts", "target_s", 1.5, [](const Config& c) { return c.model.settings.timeouts.target_s; }},
    {"timeouts", "obstacles_s", 0.5, [](const Config& c) { return c.model.settings.timeouts.obstacles_s; }},
    {"timeouts", "arm_state_s", 0.05, [](const Config& c) { return c.model.settings.timeouts.arm_state_s; }},
    {"timeouts", "arm_state_lost_s", 0.5, [](const Config& c) { return c.model.settings.timeouts.arm_state_lost_s; }},
    {"timeouts", "consistent_s", 1.5, [](const Config& c) { return c.model.settings.timeouts.consistent_s; }},
    {"timeouts", "control_s", 0.25, [](const Config& c) { return c.model.settings.timeouts.control_s; }},
    {"obstacles", "speed_bound_mps", 1.5, [](const Config& c) { return c.model.settings.obstacle_speed_bound_mps; }},
    {"limits", "velocity_radps", 1.5, [](const Config& c) { return c.model.arm.limits.velocity_radps[6]; }},
    {"limits", "acceleration_radps2", 1.5, [](const Config& c) { return c.model.arm.limits.acceleration_radps2[6]; }},
    {"sidestep", "k_pos_per_s", 0.75, [](const Config& c) { return c.model.settings.sidestep.k_pos_per_s; }},
    {"sidestep", "k_ori_per_s", 0.75, [](const Config& c) { return c.model.settings.sidestep.k_ori_per_s; }},
    {"sidestep", "k_posture_per_s", 0.75, [](const Config& c) { return c.model.settings.sidestep.k_posture_per_s; }},
    {"sidestep", "k_guide_per_s", 0.75, [](const Config& c) { return c.model.settings.sidestep.k_guide_per_s; }},
    {"sidestep", "guide_posture_share", 0.75,
     [](const Config& c) { return c.model.settings.sidestep.guide_posture_share; }},
    {"sidestep", "v_max_mps", 0.75, [](const Config& c) { return c.model.settings.sidestep.v_max_mps; }},
    {"sidestep", "lambda_0", 0.75, [](const Config& c) { return c.model.settings.sidestep.lambda_0; }},
    {"sidestep", "sigma_0", 0.75, [](const Config& c) { return c.model.settings.sidestep.sigma_0; }},
    {"shield", "rest_clearance_m", 0.003, [](const Config& c) { return c.model.settings.shield.rest_clearance_m; }},
    {"shield", "hard_clearance_m", 0.03, [](const Config& c) { return c.model.settings.shield.hard_clearance_m; }},
    {"shield", "hard_gain_per_s", 0.75, [](const Config& c) { return c.model.settings.shield.hard_gain_per_s; }},
    {"shield", "pass_clearance_m", 0.3, [](const Config& c) { return c.model.settings.shield.pass_clearance_m; }},
    {"shield", "pass_gain_per_s", 0.75, [](const Config& c) { return c.model.settings.shield.pass_gain_per_s; }},
    {"shield", "pass_reaction_s", 0.75, [](const Config& c) { return c.model.settings.shield.pass_reaction_s; }},
    {"shield", "pass_horizon_s", 0.75, [](const Config& c) { return c.model.settings.shield.pass_horizon_s; }},
    {"shield", "comfort_clearance_m", 0.75,
     [](const Config& c) { return c.model.settings.shield.comfort_clearance_m; }},
    {"shield", "comfort_gain_per_s", 0.75, [](const Config& c) { return c.model.settings.shield.comfort_gain_per_s; }},
    {"shield", "comfort_far_m", 0.55, [](const Config& c) { return c.model.settings.shield.comfort_far_m; }},
    {"shield", "comfort_near_m", 0.35, [](const Config& c) { return c.model.settings.shield.comfort_near_m; }},
    {"shield", "comfort_weight", 0.75, [](const Config& c) { return c.model.settings.shield.comfort_weight; }},
    {"shield", "comfort_least_weight", 0.75,
     [](const Config& c) { return c.model.settings.shield.comfort_least_weight; }},
    {"shield", "person_clearance_m", 0.75, [](const Config& c) { return c.model.settings.shield.person_clearance_m; }},
    {"shield", "person_gain_per_s", 0.75, [](const Config& c) { return c.model.settings.shield.person_gain_per_s; }},
    {"shield", "person_weight", 0.75, [](const Config& c) { return c.model.settings.shield.person_weight; }},
    {"shield", "tool_weight", 0.75, [](const Config& c) { return c.model.settings.shield.tool_weight; }},
    {"shield", "self_clearance_m", 0.3, [](const Config& c) { return c.model.settings.shield.self_clearance_m; }},
    {"shield", "range_m", 0.75, [](const Config& c) { return c.model.settings.shield.range_m; }},
    {"foresight", "horizon_s", 1.5, [](const Config& c) { return c.model.settings.foresight.horizon_s; }},
    {"foresight", "clearance_m", 0.3, [](const Config& c) { return c.model.settings.foresight.clearance_m; }},
    {"foresight", "seed", 9, [](const Config& c) { return static_cast<double>(c.model.settings.foresight.seed); }},
    {"timeouts", "coast_s", 1.5, [](const Config& c) { return c.model.settings.timeouts.coast_s; }},
    {"obstacles", "latency_s", 0.75, [](const Config& c) { return c.model.settings.obstacle_trust.latency_s; }},
    {"obstacles", "uncertainty_m", 0.3, [](const Config& c) { return c.model.settings.obstacle_trust.uncertainty_m; }},
    {"obstacles", "acceleration_bound_mps2", 0.75,
     [](const Config& c) { return c.model.settings.obstacle_trust.acceleration_bound_mps2; }},
    {"blackbox", "seconds", 25, [](const Config& c) { return c.blackbox.seconds; }},
    {"limits", "lower_rad", -1.5, [](const Config& c) { return c.model.arm.limits.lower_rad[6]; }},
    {"limits", "upper_rad", 1.5, [](const Config& c) { return c.model.arm.limits.upper_rad[6]; }},
};

void each_number_sets_its_own_field_only(void**) {
  const Config plain = load("");
  for (const Key& key : kNumbers) {
    const std::string yaml = std::string(key.section) + ": {" + key.key + ": " + std::to_string(key.value) + "}\n";
    const std::string error = message_of([&] { load(yaml); });
    check(error.empty(), "%s", error.c_str());
    const Config config = load(yaml);
    check_near_because(key.read(config), key.value, 1e-12, "%s.%s", key.section, key.key);
    for (const Key& other : kNumbers)
      if (&other != &key)
        check_near_because(other.read(config), other.read(plain), 0, "%s.%s changes %s", key.section, key.key,
                           other.key);
  }
}

void each_text_and_flag_sets_its_field(void**) {
  assert_true(load("law: paper").model.settings.law == Law::kPaper);
  assert_true(load("law: sidestep").model.settings.law == Law::kSidestep);
  assert_true(load("").model.settings.law == Law::kSidestep);
  assert_true(load("paper: {tool_velocity: planned}").model.settings.paper.tool_velocity == ToolVelocity::kPlanned);
  assert_true(load("paper: {tool_velocity: measured}").model.settings.paper.tool_velocity == ToolVelocity::kMeasured);
  assert_false(load("obstacles: {wait_for_first: false}").model.settings.wait_for_obstacles);
  assert_true(load("obstacles: {wait_for_first: true}").model.settings.wait_for_obstacles);
  assert_true(load("").dialect == &kSidestepDialect);
  assert_true(load("dialect: sidestep").dialect == &kSidestepDialect);
  assert_true(load("dialect: iiwa").dialect == &kIiwaDialect);
  const Channels channels =
      load(
          "channels: {target: A, obstacles: B, arm_state: C, arm_command: D, controller_status: E, loop_timing: F, "
          "other_joints: G, control: H, joint_target: I, attachments: J}")
          .channels;
  assert_string_equal(
      (channels.target + channels.obstacles + channels.arm_state + channels.arm_command + channels.controller_status +
       channels.loop_timing + channels.other_joints + channels.control + channels.joint_target + channels.attachments)
          .c_str(),
      "ABCDEFGHIJ");
  const Neighbours neighbours =
      load("neighbours: {publish: A, listen: [B, C], base_position_m: [1, 2, 3], base_rpy_rad: [0, 0, 1.5]}")
          .neighbours;
  assert_string_equal((neighbours.publish + neighbours.listen[0] + neighbours.listen[1]).c_str(), "ABC");
  check_near(neighbours.world_from_base * Vector3(1, 0, 0), Vector3(1 + std::cos(1.5), 2 + std::sin(1.5), 3), 1e-12);
  assert_string_equal(load("blackbox: {folder: here}").blackbox.folder.c_str(), "here");
}

void the_iiwa_dialect_sets_channels_and_start_guard(void**) {
  const Config iiwa = load("dialect: iiwa\nchannels: {arm_command: MINE}");
  assert_string_equal(iiwa.channels.arm_state.c_str(), "IIWA_STATUS");
  assert_string_equal(iiwa.channels.arm_command.c_str(), "MINE");
  check_near(iiwa.model.settings.start_guard_s, 0.25, 0);
  check_near(load("").model.settings.start_guard_s, 0.0, 0);
}

void links_that_need_not_keep_clear_are_read(void**) {
  const auto pairs = [](const std::string& robot) {
    return load_config(
               scratch_file("pairs.yaml", "robot: {urdf: urdf/lwa3.urdf, base: base_link, tip: tool" + robot + "}\n"),
               {})
        .model.self_pairs.size();
  };
  const size_t all = pairs("");
  assert_int_equal(pairs(", ignore_pairs: [base_link hand_link]"), all - 1);
  const std::string srdf =
      scratch_file("some.srdf", "<robot><disable_collisions link1='forearm_link' link2='base_link'/></robot>");
  assert_int_equal(pairs(", srdf: " + srdf + ", ignore_pairs: [base_link hand_link]"), all - 2);
  assert_true(one_line_with(message_of([&] { pairs(", ignore_pairs: [base_link]"); }), {"robot.ignore_pairs"}));
  assert_true(one_line_with(message_of([&] { pairs(", srdf: no/such.srdf"); }), {"no/such.srdf"}));
  assert_true(one_line_with(message_of([&] { pairs(", capsules_per_mesh: 3"); }), {"pieces_per_mesh"}));
}

void surroundings_are_read_with_shape_and_pose(void**) {
  const std::vector<Obstacle> list = load(
                                         "surroundings:\n"
                                         "  - {shape: sphere, radius_m: 0.3, position_m: [1, 2, 3]}\n"
                                         "  - {shape: capsule, radius_m: 0.1, length_m: 0.4, position_m: [1, 0, 0], "
                                         "quaternion: [0.5, 0.5, 0.5, 0.5]}\n"
                                         "  - {shape: box, edges_m: [0.2, 2, 1], position_m: [0, 0, 1]}\n"
                                         "  - {shape: cylinder, radius_m: 0.3, height_m: 0.2, position_m: [0, 0, 1]}\n")
                                         .model.surroundings;
  assert_int_equal(list.size(), 4);
  check_near(list[0].capsule.centre(), Vector3(1, 2, 3), 0);
  check_near(list[0].capsule.radius_m, 0.3, 0);
  check_near(list[1].capsule.end, Vector3(1.2, 0, 0), 1e-12);
  check_near(box_of(list[2]).half_m, Vector3(1, 0.5, 0.1), 1e-12);
  check_near(box_of(list[2]).axes.col(0).eval(), Vector3(0, 1, 0), 1e-12);
  check_near(solid_of(list[3]).half_m, Vector3(0.3, 0.3, 0.1), 1e-12);
  for (int i = 0; i < 4; ++i) {
    const Obstacle& obstacle = list[static_cast<size_t>(i)];
    assert_int_equal(obstacle.id, -2 - i);
    assert_true(obstacle.velocity_mps.isZero(0.0) && obstacle.angular_velocity_radps.isZero(0.0));
  }
  assert_true(load("").model.surroundings.empty());
}

void the_lwa3_file_holds_the_defaults(void**) {
  const std::string error = message_of([] { load_config("firmware/config/lwa3.yaml", {}); });
  check(error.empty(), "%s", error.c_str());
  const Config file = load_config("firmware/config/lwa3.yaml", {}), defaults = load("");
  for (const Key& key : kNumbers)
    check_near_because(key.read(file), key.read(defaults), 0, "%s.%s", key.section, key.key);
  assert_true(file.model.settings.shield.enabled && file.model.settings.foresight.enabled);
  assert_string_equal(file.channels.arm_state.c_str(), "ARM_STATE");
  assert_string_equal(defaults.channels.controller_status.c_str(), "CONTROLLER_STATUS");
}

/// The values of docs/paper.md, "Parameters".
void the_lwa3_file_holds_the_documented_parameters_of_the_paper(void**) {
  const PaperGains g = load_config("firmware/config/lwa3.yaml", {}).model.settings.paper;
  const std::vector<double> actual = {
      g.k_pos_per_s2, g.k_vel_per_s, g.k_rpos_m2ps2, g.k_rvel_m2ps2, g.rho_0_m, g.rho_v_m, g.rho_min_m, g.v_max_mps,
      g.lambda_0,     g.sigma_0,     g.lambda_n,     g.x_m_mps,      g.d_m_m,   g.d_1_m,   g.d_2_m,     g.k_ori_per_s};
  const std::vector<double> documented = {20,   8.94, 0.5,  0.1, 0.25, 0.25, 0.02, 1,
                                          0.08, 0.08, 0.05, 0.5, 0.3,  0.3,  0.1,  5};
  assert_true(actual == documented);
  assert_true(g.tool_velocity == ToolVelocity::kMeasured);
}

void limits_in_the_config_override_those_of_the_urdf(void**) {
  const JointLimits limits =
      load("limits:\n  velocity_radps: [1, 2, 3, 4, 5, 6, 7]\n  upper_rad: 1.25\n").model.arm.limits;
  check_near(limits.velocity_radps, JointVector::LinSpaced(7, 1, 7), 1e-12);
  check_near(limits.upper_rad, JointVector::Constant(7, 1.25), 0);
  check_near(limits.lower_rad[1], -1.97, 0);
  check_near(limits.acceleration_radps2, JointVector::Constant(7, kDefaultAcceleration_radps2), 0);
}

void position_limits_may_be_infinite(void**) {
  const JointLimits limits =
      load("limits: {lower_rad: -.inf, upper_rad: [.inf, 1, .inf, 1, .inf, 1, .inf]}").model.arm.limits;
  assert_true(std::isinf(limits.lower_rad[3]) && limits.lower_rad[3] < 0);
  assert_true(std::isinf(limits.upper_rad[0]) && limits.upper_rad[0] > 0);
  check_near(limits.upper_rad[1], 1.0, 0);
}

void the_command_line_overrides_the_config(void**) {
  const std::string file = scratch_file("config.yaml", "robot: {urdf: nowhere.urdf, base: x, tip: y}\nlaw: sidestep\n");
  const Config config = load_config(file, {"paper", "tests/data/arm6.urdf", "foot", "tip"});
  assert_true(config.model.settings.law == Law::kPaper);
  assert_int_equal(config.model.arm.joints, 6);
}

void an_arm_loads_without_a_config_file(void**) {
  const Config config = load_config("", {"", "tests/data/arm10.urdf", "l0", "l10"});
  assert_int_equal(config.model.arm.joints, 10);
  assert_true(config.model.settings.law == Law::kSidestep);
}

void empty_sections_and_comments_keep_the_defaults(void**) {
  const Config config = load("# nothing\npaper:\ntimeouts: {}\nlimits: ~\n"), plain = load("");
  for (const Key& key : kNumbers)
    check_near_because(key.read(config), key.read(plain), 0, "%s.%s", key.section, key.key);
}

/// The nearest folder above the configuration comes first, the working directory second.
void the_urdf_is_searched_in_the_folders_above_the_config(void**) {
  namespace fs = std::filesystem;
  const fs::path top = test::scratch_folder();
  fs::create_directories(top / "project/robots/one");
  fs::create_directories(top / "project/arms");
  const std::string text = text_of("tests/data/arm6.urdf");
  const std::string yaml = "robot: {urdf: arms/a.urdf, base: foot, tip: tip}\n";
  const std::string config = scratch_file("project/robots/one/config.yaml", yaml);
  const auto error = [&] { return message_of([&] { load_config(config, {}); }); };
  check(!error().empty(), "found although the file does not exist");
  scratch_file("project/arms/a.urdf", text);
  check(error().empty(), "%s", error().c_str());
  // The nearest file is used even if it is not valid: the search ends there.
  fs::create_directories(top / "project/robots/arms");
  scratch_file("project/robots/arms/a.urdf", "broken");
  check(error().find("robots/arms/a.urdf") != std::string::npos, "'%s'", error().c_str());
  // From the working directory, which is the repository's root here.
  const std::string other_urdf =
      scratch_file("project/two.yaml", replaced(yaml, "arms/a.urdf", "tests/data/arm6.urdf"));
  check(message_of([&] { load_config(other_urdf, {}); }).empty(), "not found from the working directory");
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(one_limit_for_all_joints_leaves_the_prismatic_ones_as_they_are),
      cmocka_unit_test(a_limit_that_limits_nothing_is_judged_in_the_unit_of_its_joint),
      cmocka_unit_test(positions_of_other_joints_are_read_and_the_others_are_warned_of),
      cmocka_unit_test(each_number_sets_its_own_field_only),
      cmocka_unit_test(each_text_and_flag_sets_its_field),
      cmocka_unit_test(the_iiwa_dialect_sets_channels_and_start_guard),
      cmocka_unit_test(links_that_need_not_keep_clear_are_read),
      cmocka_unit_test(surroundings_are_read_with_shape_and_pose),
      cmocka_unit_test(the_lwa3_file_holds_the_defaults),
      cmocka_unit_test(the_lwa3_file_holds_the_documented_parameters_of_the_paper),
      cmocka_unit_test(limits_in_the_config_override_those_of_the_urdf),
      cmocka_unit_test(position_limits_may_be_infinite),
      cmocka_unit_test(the_command_line_overrides_the_config),
      cmocka_unit_test(an_arm_loads_without_a_config_file),
      cmocka_unit_test(empty_sections_and_comments_keep_the_defaults),
      cmocka_unit_test(the_urdf_is_searched_in_the_folders_above_the_config),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
