#include "host/sim/world_fields.h"

#include <fmt/format.h>

#include <cmath>
#include <set>

namespace sidestep::sim {
namespace {

constexpr int kMostObstacles = 4096;  // what a message may carry
constexpr Range kPosition{-1000.0, 1000.0};
constexpr Range kVelocity{-100.0, 100.0};
constexpr Range kTime{0.0, 1e6};
constexpr double kBetweenWaypoints_s = 1e-6;  // at least
constexpr Range kSize{1e-4, 100.0};

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

Eigen::Quaterniond read_orientation(Fields& fields) {
  if (!fields.has("quaternion")) return Eigen::Quaterniond::Identity();
  const Eigen::VectorXd wxyz = fields.numbers("quaternion", 4, 4, {-1.001, 1.001});
  if (std::abs(wxyz.norm() - 1.0) > 1e-3) fields.fail("quaternion", "must have length 1 (order w x y z)");
  return Eigen::Quaterniond(wxyz[0], wxyz[1], wxyz[2], wxyz[3]).normalized();
}

Motion read_motion(Fields& fields) {
  Motion motion;
  motion.position_m = fields.vector("position_m", kPosition);
  motion.velocity_mps = fields.vector("velocity_mps", kVelocity);
  if (fields.has("waypoints")) motion.path = read_path(fields, motion);
  motion.orientation = read_orientation(fields);
  if (fields.has("angular_velocity_radps")) {
    motion.angular_velocity_radps = fields.vector("angular_velocity_radps", kVelocity);
  }
  return motion;
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

}  // namespace

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

std::vector<Obstacle> read_surroundings(Fields& config) {
  std::vector<Obstacle> surroundings;
  if (!config.has("surroundings")) return surroundings;
  for (Fields& fields : config.list("surroundings")) {
    Obstacle& thing = surroundings.emplace_back();
    thing.id = -1 - static_cast<int>(surroundings.size());
    thing.solid = read_solid(fields);
    thing.motion.position_m = fields.vector("position_m", kPosition);
    thing.motion.orientation = read_orientation(fields);
    fields.done();
  }
  return surroundings;
}

}  // namespace sidestep::sim
