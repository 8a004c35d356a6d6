#include "host/sim/scenario.h"

#include <fmt/format.h>

#include <cmath>

#include "firmware/base/find_file.h"
#include "host/sim/fields.h"
#include "host/sim/world_fields.h"

namespace sidestep::sim {
namespace {

constexpr Range kLimit{1e-6, 1e6};
constexpr char kNoConfig[] = "none";  // of a controller that got its arm by arguments

std::string found(const Fields& fields, const std::string& scenario_file, const std::string& key,
                  const std::string& file) {
  std::string found = find_file(file, scenario_file);
  if (found.empty()) fields.fail(key, fmt::format("no file '{}' here or in a folder above", file));
  return found;
}

RobotSource read_robot(Fields fields, const std::string& scenario_file) {
  RobotSource robot{
      found(fields, scenario_file, "urdf", fields.text("urdf")), fields.text("base"), fields.text("tip"), {}};
  fields.done();
  return robot;
}

// A list with one value per joint, or one number for all.
JointVector per_joint(Fields& fields, const std::string& key, int joints, Range range) {
  if (fields.is_list(key)) return fields.numbers(key, joints, joints, range);
  return JointVector::Constant(joints, fields.number(key, range));
}

PlantSpec read_plant(Fields fields, int joints) {
  PlantSpec plant;
  const std::string kind = fields.text("kind");
  if (kind == "servo") {
    plant.kind = PlantSpec::Kind::kServo;
    plant.lag_s = fields.number("lag_s", {0.0, 10.0});
    plant.latency_s = fields.number("latency_s", {0.0, 1.0});
    plant.velocity_limit_radps = per_joint(fields, "velocity_limit_radps", joints, kLimit);
    plant.acceleration_limit_radps2 = per_joint(fields, "acceleration_limit_radps2", joints, kLimit);
  } else if (kind != "ideal") {
    fields.fail("kind", fmt::format("must be ideal or servo, is '{}'", kind));
  }
  fields.done();
  return plant;
}

SensingSpec read_sensing(Fields fields) {
  SensingSpec sensing;
  sensing.joint_noise_rad = fields.number("joint_noise_rad", {0.0, 1.0});
  sensing.obstacle_noise_m = fields.number("obstacle_noise_m", {0.0, 1.0});
  sensing.lost_share = fields.number("lost_share", {0.0, 1.0});
  sensing.seed = fields.whole("seed", {0, 2147483647});
  fields.done();
  return sensing;
}

std::optional<double> maybe(Fields& fields, const std::string& key) {
  if (!fields.has(key)) return {};
  return fields.number(key, {-1000.0, 1000.0});
}

Expectations read_expectations(Fields fields) {
  const Expectations expect{maybe(fields, "final_distance_max_m"), maybe(fields, "clearance_min_m"),
                            maybe(fields, "axis_distance_min_m"), maybe(fields, "joint_speed_max_radps"),
                            maybe(fields, "joint_acceleration_max_radps2")};
  fields.done();
  return expect;
}

Published read_published(Fields fields) {
  const Published published{maybe(fields, "final_distance_m"), maybe(fields, "axis_distance_m")};
  fields.done();
  return published;
}

void read_times(Fields& fields, Scenario& scenario) {
  const int rate_hz = fields.has("rate_hz") ? fields.whole("rate_hz", {1, 1000}) : 100;
  if (1'000'000 % rate_hz != 0) fields.fail("rate_hz", "the period must be a whole number of microseconds");
  scenario.period_us = 1'000'000 / rate_hz;
  const double periods = fields.number("duration_s", {0.0, 1e6}) * rate_hz;
  scenario.periods = static_cast<int>(std::lround(periods));
  if (scenario.periods < 1 || std::abs(periods - scenario.periods) > 1e-6) {
    fields.fail("duration_s", "must be a whole number of periods, at least one");
  }
}

// What every arm has of its own; obstacles are there already.
void read_arm(Fields& fields, Scenario& scenario) {
  scenario.robot = read_robot(fields.section("robot"), scenario.file);
  scenario.controller_config = fields.text("config");
  scenario.start_rad = fields.numbers("start_rad", 1, kMaxJoints, {-100.0, 100.0});
  scenario.plant = read_plant(fields.section("plant"), static_cast<int>(scenario.start_rad.size()));
  scenario.world.target = read_target(fields.section("target"));
  if (scenario.controller_config == kNoConfig) return;
  const Place place = load_place(found(fields, scenario.file, "config", scenario.controller_config));
  scenario.robot.package_path = place.package_path;
  scenario.channels = place.channels;
  scenario.world_from_base = place.world_from_base;
  scenario.world.surroundings = place.surroundings;
}

// Those of `arms`, which look at the same world, each from its base.
std::vector<Scenario> read_arms(Fields& fields, const Scenario& common) {
  std::vector<Scenario> arms;
  for (Fields& arm : fields.list("arms")) {
    Scenario& scenario = arms.emplace_back(common);
    scenario.arm = arm.text("name");
    read_arm(arm, scenario);
    arm.done();
    scenario.world = seen_from(scenario.world_from_base.inverse(), scenario.world);
  }
  if (arms.empty()) fields.fail("arms", "at least one");
  return arms;
}

}  // namespace

std::vector<Scenario> load_scenario(const std::string& file) {
  Fields fields = Fields::from_file(file);
  Scenario scenario;
  scenario.file = file;
  scenario.title = fields.text("title");
  read_times(fields, scenario);
  if (fields.has("sensing")) scenario.sensing = read_sensing(fields.section("sensing"));
  scenario.world.obstacles = read_obstacles(fields);
  if (fields.has("expect")) scenario.expect = read_expectations(fields.section("expect"));
  if (fields.has("published")) scenario.published = read_published(fields.section("published"));
  std::vector<Scenario> arms{scenario};
  if (fields.has("arms"))
    arms = read_arms(fields, scenario);
  else
    read_arm(fields, arms.front());
  fields.done();
  return arms;
}

}  // namespace sidestep::sim
