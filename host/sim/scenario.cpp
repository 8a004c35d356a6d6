#include "host/sim/scenario.h"

#include <fmt/format.h>

#include <cmath>
#include <set>
#include <stdexcept>

#include "firmware/io/find_file.h"
#include "host/sim/fields.h"

namespace sidestep::sim {
namespace {

constexpr int kMostObstacles = 4096;  // what a message may carry
constexpr Range kPosition{-1000.0, 1000.0};
constexpr Range kVelocity{-100.0, 100.0};
constexpr Range kTime{0.0, 1e6};
constexpr double kBetweenWaypoints_s = 1e-6;  // at least
constexpr Range kSize{1e-4, 100.0};
constexpr Range kLimit{1e-6, 1e6};

RobotSource read_robot(Fields fields, const std::string& scenario_file) {
  const std::string urdf = fields.text("urdf");
  const std::string found = find_file(urdf, scenario_file);
  if (found.empty()) fields.fail("urdf", fmt::format("no file '{}' here or in a folder above", urdf));
  RobotSource robot{found, fields.text("base"), fields.text("tip")};
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

// From position_m and velocity_mps at t = 0 through the waypoints [t_s, x, y, z, vx, vy, vz].
std::shared_ptr<const Path> read_path(Fields& fields, const Motion& start) {
  Path path{{0.0, start.position_m, start.velocity_mps}};
  for (const Eigen::VectorXd& row :
       fields.rows("waypoints", {kTime, kPosition, kPosition, kPosition, kVelocity, kVelocity, kVelocity})) {
    if (row[0] < path.back().t_s + kBetweenWaypoints_s) {
      fields.fail(fmt::format("waypoints[{}][0]", path.size() - 1), "times must increase from 0");
    }
    path.push_back({row[0], row.segment<3>(1), row.segment<3>(4)});
  }
  return std::make_shared<const Path>(std::move(path));
}

Motion read_motion(Fields& fields) {
  Motion motion;
  motion.position_m = fields.vector("position_m", kPosition);
  motion.velocity_mps = fields.vector("velocity_mps", kVelocity);
  if (fields.has("waypoints")) motion.path = read_path(fields, motion);
  if (fields.has("quaternion")) {
    const Eigen::VectorXd wxyz = fields.numbers("quaternion", 4, 4, {-1.001, 1.001});
    if (std::abs(wxyz.norm() - 1.0) > 1e-3) fields.fail("quaternion", "must have length 1 (order w x y z)");
    motion.orientation = Eigen::Quaterniond(wxyz[0], wxyz[1], wxyz[2], wxyz[3]).normalized();
  }
  if (fields.has("angular_velocity_radps")) {
    motion.angular_velocity_radps = fields.vector("angular_velocity_radps", kVelocity);
  }
  return motion;
}

Target read_target(Fields fields) {
  Target target;
  target.motion = read_motion(fields);
  target.tracks_orientation = fields.has("quaternion");
  if (!target.tracks_orientation && fields.has("angular_velocity_radps")) {
    fields.fail("angular_velocity_radps", "needs a quaternion");
  }
  fields.done();
  return target;
}

Solid read_solid(Fields& fields) {
  const std::string shape = fields.text("shape");
  if (shape == "sphere") return {Shape::kSphere, {fields.number("radius_m", kSize), 0.0, 0.0}};
  if (shape == "capsule") {
    return {Shape::kCapsule, {fields.number("radius_m", kSize), fields.number("length_m", kSize), 0.0}};
  }
  if (shape != "box") fields.fail("shape", fmt::format("must be sphere, capsule or box, is '{}'", shape));
  return {Shape::kBox, fields.vector("edges_m", kSize)};
}

std::vector<Obstacle> read_obstacles(Fields& scenario) {
  std::vector<Obstacle> obstacles;
  std::set<int> ids;
  std::vector<Fields> list = scenario.list("obstacles");
  if (list.size() > kMostObstacles) scenario.fail("obstacles", fmt::format("more than {}", kMostObstacles));
  for (Fields& fields : list) {
    Obstacle obstacle;
    obstacle.id = fields.whole("id", {0, 2147483647});
    if (!ids.insert(obstacle.id).second) fields.fail("id", "used twice");
    obstacle.solid = read_solid(fields);
    obstacle.motion = read_motion(fields);
    fields.done();
    obstacles.push_back(obstacle);
  }
  return obstacles;
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

}  // namespace

Scenario load_scenario(const std::string& file) {
  Fields fields = Fields::from_file(file);
  Scenario scenario;
  scenario.file = file;
  scenario.title = fields.text("title");
  scenario.robot = read_robot(fields.section("robot"), file);
  scenario.controller_config = fields.text("config");
  read_times(fields, scenario);
  scenario.start_rad = fields.numbers("start_rad", 1, kMaxJoints, {-100.0, 100.0});
  scenario.plant = read_plant(fields.section("plant"), static_cast<int>(scenario.start_rad.size()));
  if (fields.has("sensing")) scenario.sensing = read_sensing(fields.section("sensing"));
  scenario.world.target = read_target(fields.section("target"));
  scenario.world.obstacles = read_obstacles(fields);
  if (fields.has("expect")) scenario.expect = read_expectations(fields.section("expect"));
  if (fields.has("published")) scenario.published = read_published(fields.section("published"));
  fields.done();
  return scenario;
}

}  // namespace sidestep::sim
