#include "firmware/io/config/config.h"

#include <regex>

#include "tests/support/check.h"
#include "tests/support/random.h"
#include "tests/support/scratch.h"

using namespace sidestep;
using test::message_of;
using test::one_line_with;
using test::scratch_file;
using test::text_of;

namespace {

const char kRobot[] = "robot: {urdf: urdf/lwa3.urdf, base: base_link, tip: tool}\n";

std::string error_of(const std::string& text) {
  const std::string file = scratch_file("config.yaml", text);
  return message_of([&] { load_config(file, {}); });
}

/// Checks one entry of a table without ending the test; returns 1 when the entry fails.
int report_unless(bool right, const char* yaml, const std::string& message) {
  if (!right) print_error("%s -> '%s'\n", yaml, message.c_str());
  return !right;
}

void a_bad_config_is_refused_with_one_line_naming_file_and_key(void**) {
  const struct {
    const char* yaml;
    const char* culprit;
  } cases[] = {
      // unknown keys
      {"lawn: paper", "lawn"},
      {"paper: {k_pos: 1}", "paper.k_pos"},
      {"control: {rate: 100}", "control.rate"},
      {"shield: {enable: true}", "shield.enable"},
      {"channels: {targets: T}", "channels.targets"},
      {"obstacles: {[1, 2]: 3}", "obstacles"},
      // the wrong kind
      {"law: 7", "law"},
      {"law: [paper]", "law"},
      {"dialect: kuka", "dialect"},
      {"paper: 3", "paper"},
      {"paper: [1, 2]", "paper"},
      {"paper: {k_pos_per_s2: fast}", "paper.k_pos_per_s2"},
      {"paper: {k_pos_per_s2: [1]}", "paper.k_pos_per_s2"},
      {"paper: {k_pos_per_s2: {}}", "paper.k_pos_per_s2"},
      {"paper: {k_pos_per_s2: 1.0.0}", "paper.k_pos_per_s2"},
      {"paper: {k_pos_per_s2: \"\"}", "paper.k_pos_per_s2"},
      {"paper: {tool_velocity: guessed}", "paper.tool_velocity"},
      {"obstacles: {wait_for_first: perhaps}", "obstacles.wait_for_first"},
      {"obstacles: {wait_for_first: 1}", "obstacles.wait_for_first"},
      {"channels: {target: [A]}", "channels.target"},
      {"channels: {target: \"\"}", "channels.target"},
      {"neighbours: {listen: A}", "neighbours.listen"},
      {"neighbours: {publish: A, listen: [B, A]}", "neighbours.listen"},
      {"neighbours: {listen: [B, B]}", "neighbours.listen"},
      {"neighbours: {listen: [OBSTACLES]}", "neighbours.listen"},
      {"neighbours: {publish: ARM_COMMAND}", "neighbours.publish"},
      {"neighbours: {listen: [A, \"B\\nC\"]}", "neighbours.listen"},
      {"neighbours: {listen: [A, B, C, D, E, F, G, H, I, J, K, L, M, N, O, P, Q]}", "neighbours.listen"},
      {"neighbours: {listen: [A_NAME_THAT_IS_LONGER_THAN_THE_SIXTY_THREE_BYTES_THAT_LCM_CAN_SEND]}",
       "neighbours.listen"},
      {"channels: {target: X, obstacles: X}", "channels.obstacles"},
      {"neighbours: {listen: [A]}\nobstacles: {wait_for_first: false}", "neighbours.listen"},
      {"neighbours: {base_position_m: [1, 2]}", "neighbours.base_position_m"},
      {"neighbours: {base_position_m: [1, 2, 1e308]}", "neighbours.base_position_m"},
      {"neighbours: {base_rpy_rad: [1, 2, .inf]}", "neighbours.base_rpy_rad"},
      // out of range
      {"paper: {k_pos_per_s2: .nan}", "paper.k_pos_per_s2"},
      {"paper: {k_pos_per_s2: .inf}", "paper.k_pos_per_s2"},
      {"paper: {k_pos_per_s2: -1}", "paper.k_pos_per_s2"},
      {"paper: {rho_min_m: 0}", "paper.rho_min_m"},
      {"paper: {lambda_n: 0}", "paper.lambda_n"},
      {"paper: {d_m_m: -0.1}", "paper.d_m_m"},
      {"paper: {d_1_m: 0.05}", "paper.d_2_m"},
      {"paper: {d_2_m: 0.3}", "paper.d_2_m"},
      {"control: {rate_hz: 0}", "control.rate_hz"},
      {"control: {rate_hz: 1e9}", "control.rate_hz"},
      {"blackbox: {seconds: 0}", "blackbox.seconds"},
      {"foresight: {seed: 1.7}", "foresight.seed"},
      {"blackbox: {seconds: 61}", "blackbox.seconds"},
      {"timeouts: {coast_s: 11}", "timeouts.coast_s"},
      {"shield: {pass_horizon_s: 11}", "shield.pass_horizon_s"},
      {"blackbox: {file: log}", "blackbox.file"},
      {"control: {rate_hz: -100}", "control.rate_hz"},
      {"control: {following_error_rad: 0}", "control.following_error_rad"},
      {"timeouts: {target_s: 0}", "timeouts.target_s"},
      {"timeouts: {arm_state_s: 0.2}", "timeouts.arm_state_lost_s"},
      {"timeouts: {consistent_s: -1}", "timeouts.consistent_s"},
      {"obstacles: {speed_bound_mps: -1}", "obstacles.speed_bound_mps"},
      {"channels: {target: A_NAME_THAT_IS_LONGER_THAN_THE_SIXTY_THREE_BYTES_THAT_LCM_CAN_SEND}", "channels.target"},
      // limits
      {"limits: {velocity_radps: [1, 2, 3]}", "limits.velocity_radps"},
      {"limits: {velocity_radps: [1, 2, 3, 4, 5, 6, 7, 8]}", "limits.velocity_radps"},
      {"limits: {velocity_radps: [1, 2, 3, 4, 5, 6, x]}", "limits.velocity_radps"},
      {"limits: {velocity_radps: [1, 2, 3, 4, 5, 6, [7]]}", "limits.velocity_radps"},
      {"limits: {velocity_radps: .nan}", "limits.velocity_radps"},
      {"limits: {velocity_radps: 0}", "velocity"},
      {"limits: {velocity_radps: .inf}", "velocity"},
      {"limits: {velocity_radps: 1e300}", "velocity"},
      {"limits: {acceleration_radps2: 1e300}", "acceleration"},
      {"limits: {acceleration_radps2: -10}", "acceleration"},
      {"limits: {acceleration_radps2: .inf}", "acceleration"},
      {"shield: {pass_clearance_m: 0.3, range_m: 0.2}", "shield.range_m"},
      {"limits: {lower_rad: 2, upper_rad: 1}", "lower"},
      {"limits: {upper_rad: [6, -2, 6, 2, 6, 2, 6]}", "joint_2"},
      // surroundings
      {"surroundings: table", "surroundings"},
      {"surroundings: [table]", "surroundings[0]"},
      {"surroundings: [{position_m: [0, 0, 0]}]", "surroundings[0].shape"},
      {"surroundings: [{shape: cone, position_m: [0, 0, 0]}]", "surroundings[0].shape"},
      {"surroundings: [{shape: sphere, radius_m: 1}]", "surroundings[0].position_m"},
      {"surroundings: [{shape: sphere, position_m: [0, 0], radius_m: 1}]", "surroundings[0].position_m"},
      {"surroundings: [{shape: sphere, position_m: [0, 0, .nan], radius_m: 1}]", "surroundings[0].position_m"},
      {"surroundings: [{shape: sphere, position_m: [0, 0, 0]}]", "surroundings[0].radius_m"},
      {"surroundings: [{shape: sphere, position_m: [0, 0, 0], radius_m: 0}]", "surroundings[0].radius_m"},
      {"surroundings: [{shape: capsule, position_m: [0, 0, 0], radius_m: 1}]", "surroundings[0].length_m"},
      {"surroundings: [{shape: box, position_m: [0, 0, 0]}]", "surroundings[0].edges_m"},
      {"surroundings: [{shape: box, position_m: [0, 0, 0], edges_m: [1, 1, -1]}]", "surroundings[0].edges_m"},
      {"surroundings: [{shape: box, position_m: [0, 0, 0], edges_m: [1, 1, 1], quaternion: [1, 1, 0, 0]}]",
       "surroundings[0].quaternion"},
      {"surroundings: [{shape: sphere, position_m: [0, 0, 0], radius_m: 1, edges_m: [1, 1, 1]}]",
       "surroundings[0].edges_m"},
      {"surroundings: [{shape: sphere, position_m: [0, 0, 1], radius_m: 1}, {}]", "surroundings[1].shape"},
      // null where a value is required
      {"surroundings: [{shape: sphere, position_m: [0, 0, 0], radius_m: ~}]", "surroundings[0].radius_m: is missing"},
      {"surroundings: [{shape: box, position_m: [0, 0, 0], edges_m: [1, 1, 1], quaternion: ~}]",
       "surroundings[0].quaternion"},
      {"surroundings: [{shape: sphere, position_m: [0, 0, 0], radius_m: 1, quaternion: [1, 0, 0, 0]}]",
       "surroundings[0].quaternion: unknown key"},
      // given twice
      {"law: paper\nlaw: paper", "law: is given twice"},
      {"paper: {d_1_m: 0.3, d_1_m: 0.3}", "paper.d_1_m: is given twice"},
      {"timeouts: {}\ntimeouts: {}", "timeouts: is given twice"},
      {"---\nlaw: paper", "second document"},
      {"...\n{law: paper}", "second document"},
  };
  int wrong = 0;
  for (const auto& bad : cases) {
    const std::string message = error_of(std::string(kRobot) + bad.yaml + "\n");
    wrong += report_unless(one_line_with(message, {"config.yaml", bad.culprit}), bad.yaml, message);
  }
  assert_int_equal(wrong, 0);
}

/// Every number of the reference configuration has a range at the beginning of its comment, or "above 0" for limits.
void a_number_beyond_the_documented_range_is_refused(void**) {
  const std::string reference = text_of("firmware/config/lwa3.yaml");
  const std::regex line("(^|\n)((\\w+):|  (\\w+): ([-.0-9]+) +(# ([.0-9e]+) to ([.0-9e]+))?)");
  std::string section;
  int ranges = 0, wrong = 0;
  for (std::sregex_iterator at(reference.begin(), reference.end(), line), end; at != end; ++at) {
    if (at->str(3).size() > 0) section = at->str(3);
    const std::string key = at->str(4);
    if (key.empty()) continue;
    check(at->str(6).size() > 0, "%s.%s has no documented range", section.c_str(), key.c_str());
    const double lowest = std::stod(at->str(7)), highest = std::stod(at->str(8));
    for (const double beyond : {lowest > 0.0 ? 0.99 * lowest : -1e-6, 1.01 * highest, 1e308}) {
      const std::string yaml = section + ": {" + key + ": " + std::to_string(beyond) + "}";
      const std::string message = error_of(kRobot + yaml + "\n");
      wrong += report_unless(one_line_with(message, {section + "." + key + ": is "}), yaml.c_str(), message);
    }
    for (const std::string& bound : {at->str(7), at->str(8)}) {
      const std::string yaml = section + ": {" + key + ": " + bound + "}";
      const std::string message = error_of(kRobot + yaml + "\n");  // other keys may contradict
      wrong += report_unless(message.find(": is ") == std::string::npos, yaml.c_str(), message);
    }
    ++ranges;
  }
  assert_int_equal(wrong, 0);
  check(ranges > 50, "only %d ranges", ranges);
}

/// Values that may have a reason in an experiment.
void a_protection_that_is_switched_off_is_warned_of(void**) {
  const struct {
    const char* yaml;
    const char* warning;
  } cases[] = {
      {"shield: {enabled: false}", "shield.enabled"},
      {"foresight: {enabled: false}", "foresight.enabled"},
      {"obstacles: {wait_for_first: false}", "obstacles.wait_for_first"},
      {"timeouts: {coast_s: 0}", "timeouts.coast_s"},
      {"limits: {upper_rad: [6, 2, 6, 1, 6, 1, 6]}", "joint_2"},
      {"limits: {velocity_radps: [2, 2, 2, 2, 2, 2, 3]}", "joint_7"},
      {"limits: {acceleration_radps2: [10, 10, 10, 201, 10, 10, 10]}", "joint_4"},
  };
  for (const auto& each : cases) {
    const Config config = load_config(scratch_file("config.yaml", std::string(kRobot) + each.yaml), {});
    assert_int_equal(config.warnings.size(), 1);
    check(config.warnings[0].find(each.warning) != std::string::npos, "%s", config.warnings[0].c_str());
  }
  for (const char* file : {"lwa3", "iiwa14", "iiwa14-drake", "panda", "table", "left"})
    check(load_config("firmware/config/" + std::string(file) + ".yaml", {}).warnings.empty(), "%s", file);
}

void a_renamed_key_is_refused_with_its_new_name(void**) {
  const struct {
    const char* yaml;
    const char* error;
  } cases[] = {
      {"ages: {target_s: 1}", "config.yaml: ages: this key is now called 'timeouts'"},
      {"ages: {}", "config.yaml: ages: this key is now called 'timeouts'"},
      {"ages:", "config.yaml: ages: this key is now called 'timeouts'"},
      {"timeouts: {old_place_s: 0.3}", "config.yaml: timeouts.old_place_s: this key is now called 'coast_s'"},
      {"timeouts: {coast_s: 0.3, old_place_s: ~}",
       "config.yaml: timeouts.old_place_s: this key is now called 'coast_s'"},
  };
  int wrong = 0;
  for (const auto& bad : cases) {
    const std::string message = error_of(std::string(kRobot) + bad.yaml + "\n");
    wrong += report_unless(one_line_with(message, {bad.error}), bad.yaml, message);
  }
  assert_int_equal(wrong, 0);
}

void an_error_is_short_and_holds_no_control_characters(void**) {
  const std::string long_name(100'000, 'x');
  for (const std::string& yaml : {long_name + ": 1", "law: " + long_name, "paper: {" + long_name + ": 1}",
                                  "channels: {target: [" + long_name + "]}", std::string("\"a\\nb\\x07\": 1"),
                                  std::string("law: \"a\\nb\\x1b\"")}) {
    const std::string message = error_of(kRobot + yaml + "\n");
    check(one_line_with(message, {"config.yaml: "}) && message.size() < 600, "%.40s -> %zu characters", yaml.c_str(),
          message.size());
    for (const char c : message) check(c >= 0x20 && c != 0x7f, "%.40s -> character %d", yaml.c_str(), c);
  }
}

void a_bad_robot_is_refused_with_one_line(void**) {
  const struct {
    const char* yaml;
    const char* culprit;
  } cases[] = {
      {"", "robot.urdf"},
      {"robot: {base: base_link, tip: tool}", "robot.urdf"},
      {"robot: {urdf: urdf/lwa3.urdf, tip: tool}", "robot.base"},
      {"robot: {urdf: urdf/lwa3.urdf, base: base_link}", "robot.tip"},
      {"robot: {urdf: urdf/none.urdf, base: base_link, tip: tool}",
       "config.yaml: robot.urdf: there is no file 'urdf/none.urdf' in the folder of the configuration"},
      {"robot: {urdf: urdf/lwa3.urdf, base: elbow, tip: tool}", "elbow"},
      {"robot: {urdf: urdf/lwa3.urdf, base: base_link, tip: hook}", "hook"},
      {"robot: {urdf: urdf/lwa3.urdf, base: base_link, tip: tool, tool: 1}", "robot.tool"},
      {"robot: urdf/lwa3.urdf", "robot"},
      {"robot: {urdf: \"a\\nb\", base: base_link, tip: tool}", "robot.urdf"},
      {"robot: {urdf: [], base: base_link, tip: tool}", "robot.urdf"},
      {"robot: {urdf: tests/data/arm6.urdf, base: foot, tip: tip}\ndialect: iiwa", "dialect"},
  };
  int wrong = 0;
  for (const auto& bad : cases) {
    const std::string message = error_of(bad.yaml);
    wrong += report_unless(one_line_with(message, {bad.culprit}), bad.yaml, message);
  }
  assert_int_equal(wrong, 0);
}

void a_file_name_that_is_too_long_is_refused_with_one_line(void**) {
  const std::string name(5000, 'u');
  const std::string robot = "robot: {urdf: " + name + ", base: base_link, tip: tool}";
  assert_true(one_line_with(error_of(robot), {"config.yaml: robot.urdf: there is no file 'uuu"}));
}

void text_that_is_not_yaml_is_refused_with_one_line(void**) {
  const std::string zeros(300, '\0'), deep(20000, '['), braces(20000, '{');
  for (const std::string& text :
       {std::string("robot: [1, 2"), std::string("a: b: c"), std::string("\t- x"), std::string("- a\n- b"),
        std::string("just words"), std::string("%YAML 9\n"), std::string("&a *a"), zeros,
        std::string("\xff\xfe\x00x", 4), std::string("*unknown"), std::string("? [a"), deep, braces}) {
    const std::string message = error_of(text);
    check(one_line_with(message, {"config.yaml"}), "%.40s -> '%.200s'", text.c_str(), message.c_str());
  }
}

void an_unreadable_file_is_named_in_the_error(void**) {
  const std::string missing = message_of([] { load_config("no/such/file.yaml", {}); });
  check(one_line_with(missing, {"no/such/file.yaml"}), "'%s'", missing.c_str());
  const std::string folder = message_of([] { load_config("firmware/config", {}); });
  check(one_line_with(folder, {"firmware/config: cannot be read"}), "'%s'", folder.c_str());
  const std::string endless = message_of([] { load_config("/dev/zero", {}); });
  check(one_line_with(endless, {"/dev/zero", "larger"}), "'%s'", endless.c_str());
}

void a_truncated_config_never_crashes(void**) {
  const std::string good = text_of("firmware/config/lwa3.yaml");
  int loaded = 0;
  for (size_t length = 0; length < good.size(); ++length) {
    const std::string message = error_of(good.substr(0, length));
    check(message.empty() || one_line_with(message, {}), "%zu bytes: '%s'", length, message.c_str());
    loaded += message.empty();
  }
  check(loaded > 100, "only %d prefixes are valid configurations", loaded);
}

void a_scrambled_config_never_crashes(void**) {
  const std::string good = text_of("firmware/config/lwa3.yaml");
  test::Random random(1);
  for (int trial = 0; trial < 2000; ++trial) {
    std::string text = good;
    for (int change = random.index(5); change >= 0; --change)
      text[static_cast<size_t>(random.index(static_cast<int>(text.size())))] = static_cast<char>(random.bits());
    const std::string message = error_of(text);
    check(message.empty() || one_line_with(message, {}), "trial %d: '%s'", trial, message.c_str());
  }
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_bad_config_is_refused_with_one_line_naming_file_and_key),
      cmocka_unit_test(a_number_beyond_the_documented_range_is_refused),
      cmocka_unit_test(a_protection_that_is_switched_off_is_warned_of),
      cmocka_unit_test(a_renamed_key_is_refused_with_its_new_name),
      cmocka_unit_test(an_error_is_short_and_holds_no_control_characters),
      cmocka_unit_test(a_bad_robot_is_refused_with_one_line),
      cmocka_unit_test(a_file_name_that_is_too_long_is_refused_with_one_line),
      cmocka_unit_test(text_that_is_not_yaml_is_refused_with_one_line),
      cmocka_unit_test(an_unreadable_file_is_named_in_the_error),
      cmocka_unit_test(a_truncated_config_never_crashes),
      cmocka_unit_test(a_scrambled_config_never_crashes),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
