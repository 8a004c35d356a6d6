#include "host/sim/world_section.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "firmware/io/config/yaml_geometry.h"
#include "firmware/model/attachments.h"

namespace sidestep::sim {
namespace {

constexpr int kMaxScenarioObstacles = 4096;  // what a message can hold
constexpr NumberRange kVelocityRange{-100.0, 100.0};
constexpr NumberRange kTimeRange_s{0.0, 1e6};
constexpr double kMinWaypointInterval_s = 1e-6;

/// The path from the position and velocity at t = 0 through the waypoints [t_s, x, y, z, vx, vy, vz].
std::shared_ptr<const Path> read_path(YamlSection& section, const Motion& start) {
  Path path{{0.0, start.position_m, start.velocity_mps}};
  for (const Eigen::VectorXd& row :
       section.rows("waypoints", {kTimeRange_s, kPositionRange_m, kPositionRange_m, kPositionRange_m, kVelocityRange,
                                  kVelocityRange, kVelocityRange})) {
    if (row[0] < path.back().t_s + kMinWaypointInterval_s)
      section.fail(fmt::format("waypoints[{}][0]", path.size() - 1), "times must increase from 0");
    path.push_back({row[0], row.segment<3>(1), row.segment<3>(4)});
  }
  return std::make_shared<const Path>(std::move(path));
}

Motion read_motion(YamlSection& section) {
  Motion motion;
  motion.position_m = read_position(section);
  motion.velocity_mps = section.vector("velocity_mps", kVelocityRange);
  if (section.has("waypoints")) motion.path = read_path(section, motion);
  motion.orientation = read_orientation(section);
  if (section.has("angular_velocity_radps"))
    motion.angular_velocity_radps = section.vector("angular_velocity_radps", kVelocityRange);
  return motion;
}

/// A list of ids; empty when absent.
std::vector<int32_t> read_ids(YamlSection& section, const std::string& key, int most) {
  if (!section.has(key)) return {};
  std::vector<int32_t> ids;
  for (const double number : section.numbers(key, 0, most, {-2147483648.0, 2147483647.0})) {
    ids.push_back(static_cast<int32_t>(number));
    if (ids.back() != number) section.fail(key, "must be whole numbers");
  }
  return ids;
}

Solid solid_of(const ShapeSize& shape) {
  switch (shape.kind) {
    case ShapeKind::kCapsule:
      return {Shape::kCapsule, shape.size_m};
    case ShapeKind::kCylinder:
      return {Shape::kCylinder, shape.size_m};
    case ShapeKind::kBox:
      return {Shape::kBox, shape.size_m};
    case ShapeKind::kSphere:
      break;
  }
  return {Shape::kSphere, shape.size_m};
}

}  // namespace

Target read_target(YamlSection section) {
  Target target;
  if (section.has("joints_rad")) {
    target.joints_rad = section.numbers("joints_rad", 1, kMaxJoints, {-100.0, 100.0});
    section.finish();
    return target;
  }
  target.motion = read_motion(section);
  target.tracks_orientation = section.has("quaternion");
  if (!target.tracks_orientation && section.has("angular_velocity_radps"))
    section.fail("angular_velocity_radps", "needs a quaternion");
  section.finish();
  return target;
}

std::vector<Obstacle> read_obstacles(YamlSection& scenario) {
  scenario.require("obstacles");
  std::vector<YamlSection> sections = scenario.sections("obstacles");
  if (sections.size() > kMaxScenarioObstacles)
    scenario.fail("obstacles", fmt::format("more than {}", kMaxScenarioObstacles));
  std::vector<Obstacle> obstacles;
  std::set<int> ids;
  for (YamlSection& section : sections) {
    Obstacle obstacle;
    obstacle.id = section.whole("id", {0, 2147483647});
    if (!ids.insert(obstacle.id).second) section.fail("id", "used twice");
    obstacle.solid = solid_of(read_shape(section));
    obstacle.motion = read_motion(section);
    std::string kind = "thing";
    section.choice("kind", kind, {"thing", "person"});
    obstacle.is_person = kind == "person";
    section.finish();
    obstacles.push_back(obstacle);
  }
  return obstacles;
}

std::vector<GraspStep> read_grasp(YamlSection& scenario, const std::vector<Obstacle>& obstacles) {
  std::vector<GraspStep> steps;
  for (YamlSection& section : scenario.sections("grasp")) {
    GraspStep& step = steps.emplace_back();
    step.at_s = section.number("at_s", kTimeRange_s);
    if (steps.size() > 1 && step.at_s < steps[steps.size() - 2].at_s) section.fail("at_s", "must not decrease");
    step.held = read_ids(section, "held", kMaxHeldShapes);
    step.allowed = read_ids(section, "allowed", kMaxAllowed);
    for (const int32_t id : step.held)
      if (std::none_of(obstacles.begin(), obstacles.end(), [id](const Obstacle& o) { return o.id == id; }))
        section.fail("held", fmt::format("there is no obstacle {}", id));
    section.finish();
  }
  return steps;
}

std::vector<Obstacle> read_surroundings(YamlSection& config) {
  std::vector<Obstacle> surroundings;
  for (const RestingShape& entry : read_resting_shapes(config)) {
    Obstacle& obstacle = surroundings.emplace_back();
    obstacle.id = entry.id;
    obstacle.solid = solid_of(entry.shape);
    obstacle.motion.position_m = entry.position_m;
    obstacle.motion.orientation = entry.orientation;
  }
  return surroundings;
}

}  // namespace sidestep::sim
