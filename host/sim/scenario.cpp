#include "host/sim/scenario.h"

#include <fmt/format.h>

#include <cmath>

#include "firmware/base/find_file.h"
#include "firmware/io/config/yaml_section.h"
#include "host/sim/world_section.h"

namespace sidestep::sim {
namespace {

constexpr NumberRange kLimitRange{1e-6, 1e6};  // of joint speeds and accelerations
constexpr char kNoConfig[] = "none";           // the controller gets its arm by arguments

std::string find(const YamlSection& section, const std::string& scenario_file, const std::string& key,
                 const std::string& file) {
  std::string found = find_file(file, scenario_file);
  if (found.empty()) section.fail(key, fmt::format("no file '{}' here or in a folder above", file));
  return found;
}

RobotSource read_robot(YamlSection section, const std::string& scenario_file) {
  RobotSource robot{
      find(section, scenario_file, "urdf", section.text("urdf")), section.text("base"), section.text("tip"), {}, {}};
  section.finish();
  return robot;
}

PlantSpec read_plant(YamlSection section, int joints) {
  PlantSpec plant;
  if (section.choice("kind", {"ideal", "servo"}) == "servo") {
    plant.kind = PlantSpec::Kind::kServo;
    plant.lag_s = section.number("lag_s", {0.0, 10.0});
    plant.latency_s = section.number("latency_s", {0.0, 1.0});
    plant.velocity_limit_radps = section.per_joint("velocity_limit_radps", joints, kLimitRange);
    plant.acceleration_limit_radps2 = section.per_joint("acceleration_limit_radps2", joints, kLimitRange);
  }
  section.finish();
  return plant;
}

SensingSpec read_sensing(YamlSection section) {
  SensingSpec sensing;
  sensing.joint_noise_rad = section.number("joint_noise_rad", {0.0, 1.0});
  sensing.obstacle_noise_m = section.number("obstacle_noise_m", {0.0, 1.0});
  sensing.lost_share = section.number("lost_share", {0.0, 1.0});
  sensing.seed = section.whole("seed", {0, 2147483647});
  section.finish();
  return sensing;
}

std::optional<double> optional_number(YamlSection& section, const std::string& key) {
  if (!section.has(key)) return {};
  return section.number(key, {-1000.0, 1000.0});
}

Expectations read_expectations(YamlSection section) {
  const Expectations expect{
      optional_number(section, "final_distance_max_m"), optional_number(section, "clearance_min_m"),
      optional_number(section, "axis_distance_min_m"), optional_number(section, "joint_speed_max_radps"),
      optional_number(section, "joint_acceleration_max_radps2")};
  section.finish();
  return expect;
}

Published read_published(YamlSection section) {
  const Published published{optional_number(section, "final_distance_m"), optional_number(section, "axis_distance_m")};
  section.finish();
  return published;
}

void read_times(YamlSection& section, Scenario& scenario) {
  const int rate_hz = section.has("rate_hz") ? section.whole("rate_hz", {1, 1000}) : 100;
  if (1'000'000 % rate_hz != 0) section.fail("rate_hz", "the period must be a whole number of microseconds");
  scenario.period_us = 1'000'000 / rate_hz;
  if (!section.has("duration_s")) return;
  const double periods = section.number("duration_s", {0.0, 1e6}) * rate_hz;
  scenario.periods = static_cast<int>(std::lround(periods));
  if (scenario.periods < 1 || std::abs(periods - scenario.periods) > 1e-6) {
    section.fail("duration_s", "must be a whole number of periods, at least one");
  }
}

// The keys of one arm. The keys that arms share have been read into `scenario` before.
void read_arm(YamlSection& section, Scenario& scenario) {
  scenario.robot = read_robot(section.section("robot"), scenario.file);
  scenario.controller_config = section.text("config");
  scenario.start_rad = section.numbers("start_rad", 1, kMaxJoints, {-100.0, 100.0});
  scenario.plant = read_plant(section.section("plant"), static_cast<int>(scenario.start_rad.size()));
  if (section.has("target")) scenario.world.target = read_target(section.section("target"));
  if (scenario.controller_config == kNoConfig) return;
  const ArmSetup setup = load_arm_setup(find(section, scenario.file, "config", scenario.controller_config));
  scenario.robot.package_path = setup.package_path;
  scenario.robot.joint_positions = setup.joint_positions;
  scenario.channels = setup.channels;
  scenario.world_from_base = setup.world_from_base;
  scenario.world.surroundings = setup.surroundings;
}

// An expectation that nothing can break is a mistake.
void check_expectations(const YamlSection& root, const Scenario& scenario) {
  const Expectations& expect = scenario.expect;
  if (root.has("expect") && scenario.endless()) root.fail("expect", "needs duration_s: it is checked at the end");
  if (expect.final_distance_max_m && !scenario.world.target) root.fail("expect.final_distance_max_m", "needs a target");
  if ((expect.clearance_min_m || expect.axis_distance_min_m) && scenario.world.obstacles_from_others)
    root.fail("expect", "clearances need obstacles ([] for none)");
}

// The list `arms`. Targets and obstacles are given in the world frame; each scenario has them in its base frame.
std::vector<Scenario> read_arms(YamlSection& section, const Scenario& common) {
  std::vector<Scenario> arms;
  for (YamlSection& arm : section.sections("arms")) {
    Scenario& scenario = arms.emplace_back(common);
    scenario.arm = arm.text("name");
    read_arm(arm, scenario);
    arm.finish();
    scenario.world = transformed(scenario.world_from_base.inverse(), scenario.world);
  }
  if (arms.empty()) section.fail("arms", "at least one");
  return arms;
}

}  // namespace

std::vector<Scenario> load_scenario(const std::string& file) {
  YamlSection root = YamlSection::of_file(file);
  Scenario scenario;
  scenario.file = file;
  scenario.title = root.text("title");
  read_times(root, scenario);
  if (root.has("sensing")) scenario.sensing = read_sensing(root.section("sensing"));
  scenario.world.obstacles_from_others = !root.has("obstacles");
  if (root.has("obstacles")) scenario.world.obstacles = read_obstacles(root);
  if (root.has("expect")) scenario.expect = read_expectations(root.section("expect"));
  if (root.has("published")) scenario.published = read_published(root.section("published"));
  std::vector<Scenario> arms{scenario};
  if (root.has("arms"))
    arms = read_arms(root, scenario);
  else {
    read_arm(root, arms.front());
    arms.front().grasp = read_grasp(root, scenario.world.obstacles);
  }
  for (const Scenario& arm : arms) check_expectations(root, arm);
  root.finish();
  return arms;
}

}  // namespace sidestep::sim
