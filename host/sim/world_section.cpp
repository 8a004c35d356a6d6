#include "host/sim/world_section.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "firmware/io/config/yaml_geometry.h"
#include "firmware/model/attachments.h"
#include "host/people/postures.h"

namespace sidestep::sim {
namespace {

constexpr int kMaxScenarioObstacles = 4096;  // what a message can hold
constexpr NumberRange kVelocityRange{-100.0, 100.0};
constexpr NumberRange kTimeRange_s{0.0, 1e6};
constexpr NumberRange kPostureTimeRange_s{0.0, 3600.0};
constexpr NumberRange kHandRange_m{-3.0, 3.0};
constexpr NumberRange kAngleRange_rad{-100.0, 100.0};
constexpr double kMinWaypointInterval_s = 1e-6;
constexpr double kArmRadius_m = 0.048;  // of a person

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

/// What a scenario says about a person's posture. What an entry leaves out is as in the one before.
struct PostureEntry {
  Vector3 floor_m;
  double heading_rad = 0.0, lean_rad = 0.0;
  double sitting = 0.0;  ///< 0: stands; 1: sits with horizontal thighs
  /// Of the middle of the hand in the person's frame: from the floor below the hips x forward, y to the left, z up.
  /// Absent: the arm hangs.
  std::array<std::optional<Vector3>, 2> hand_m;
};

void read_posture(YamlSection& section, bool first, PostureEntry& entry) {
  if (first || section.has("position_m")) entry.floor_m = read_position(section);
  if (first) section.require("heading_rad");
  section.number("heading_rad", entry.heading_rad, kAngleRange_rad);
  section.number("lean_rad", entry.lean_rad, {-0.5, 1.5});
  section.number("sitting", entry.sitting, {0.0, 1.0});
  if (section.has("hands") && section.choice("hands", {"hanging"}) == "hanging") entry.hand_m = {};
  if (section.has("left_hand_m")) entry.hand_m[0] = section.vector("left_hand_m", kHandRange_m);
  if (section.has("right_hand_m")) entry.hand_m[1] = section.vector("right_hand_m", kHandRange_m);
  section.finish();
}

Posture posture_of(const PostureEntry& entry, const Anatomy& anatomy) {
  Posture posture = standing(anatomy, entry.floor_m, entry.heading_rad);
  posture.lean_rad = entry.lean_rad;
  const double bend_rad = entry.sitting * M_PI / 2.0;
  posture.rise_m = -anatomy.thigh_m() * (1.0 - std::cos(bend_rad));
  posture.hip_rad = posture.knee_rad = {bend_rad, bend_rad};
  for (const size_t side : {0u, 1u})
    if (entry.hand_m[side])
      posture.hand_m[side] = *entry.hand_m[side] - shoulder_m(anatomy, side) - Vector3(0.0, 0.0, posture.rise_m);
  return posture;
}

std::vector<TimedPosture> read_postures(YamlSection& person, const Anatomy& anatomy) {
  std::vector<TimedPosture> postures;
  PostureEntry entry;
  for (YamlSection& section : person.sections("postures")) {
    const double at_s = section.number("at_s", kPostureTimeRange_s);
    if (!postures.empty() && at_s < postures.back().at_s + kMinWaypointInterval_s)
      section.fail("at_s", "times must increase");
    read_posture(section, postures.empty(), entry);
    postures.push_back({at_s, posture_of(entry, anatomy)});
  }
  if (postures.empty()) person.fail("postures", "at least one");
  return postures;
}

/// A capsule for each part of the body.
std::vector<Obstacle> read_person(YamlSection& section) {
  const int32_t first_id = section.whole("id", {0, 2147483647 - kBodyParts});
  const Anatomy anatomy{section.number("stature_m", {1.0, 2.2}), kArmRadius_m};
  const std::vector<TimedPosture> postures = read_postures(section, anatomy);
  std::vector<Obstacle> parts;
  for (CapsulePath& path : record(
           anatomy, [&](double t_s) { return posture_at(postures, t_s); }, postures.back().at_s)) {
    const Capsule capsule = path.at(0.0).capsule;
    const Solid solid{Shape::kCapsule, {capsule.radius_m, (capsule.end - capsule.start).norm(), 0.0}};
    const auto id = first_id + static_cast<int32_t>(parts.size());
    parts.push_back({id, solid, motion_of_limb(std::move(path)), true});
  }
  return parts;
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
    section.text("name", obstacle.name);
    section.finish();
    obstacles.push_back(obstacle);
  }
  for (YamlSection& section : scenario.sections("people")) {
    for (const Obstacle& part : read_person(section)) {
      if (!ids.insert(part.id).second) section.fail("id", fmt::format("{} is used twice", part.id));
      obstacles.push_back(part);
    }
    section.finish();
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
