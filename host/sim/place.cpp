#include "host/sim/place.h"

#include "host/sim/world_fields.h"

namespace sidestep::sim {
namespace {

constexpr Range kAnywhere_m{-1e6, 1e6}, kAnyAngle_rad{-1e6, 1e6};

Channels read_channels(Fields fields) {
  Channels channels;
  const auto read = [&](const char* key, std::string& name) {
    if (fields.has(key)) name = fields.text(key);
  };
  read("target", channels.target);
  read("obstacles", channels.obstacles);
  read("arm_state", channels.arm_state);
  read("arm_command", channels.arm_command);
  read("controller_status", channels.controller_status);
  return channels;
}

/// Roll, pitch, yaw, as in a URDF.
Eigen::Isometry3d read_base(Fields neighbours) {
  using Eigen::AngleAxisd, Eigen::Vector3d;
  Eigen::Isometry3d world_from_base = Eigen::Isometry3d::Identity();
  if (neighbours.has("base_position_m"))
    world_from_base.translation() = neighbours.vector("base_position_m", kAnywhere_m);
  if (!neighbours.has("base_rpy_rad")) return world_from_base;
  const Vector3d rpy = neighbours.vector("base_rpy_rad", kAnyAngle_rad);
  return world_from_base * AngleAxisd(rpy.z(), Vector3d::UnitZ()) * AngleAxisd(rpy.y(), Vector3d::UnitY()) *
         AngleAxisd(rpy.x(), Vector3d::UnitX());
}

/// The rest of the section is the scenario's own.
std::vector<std::string> read_package_path(Fields robot) {
  if (!robot.has("package_path")) return {};
  return robot.texts("package_path");
}

}  // namespace

Place load_place(const std::string& config_file) {
  Fields config = Fields::from_file(config_file);
  Place place;
  if (config.has("channels")) place.channels = read_channels(config.section("channels"));
  if (config.has("neighbours")) place.world_from_base = read_base(config.section("neighbours"));
  if (config.has("robot")) place.package_path = read_package_path(config.section("robot"));
  place.surroundings = read_surroundings(config);
  return place;
}

}  // namespace sidestep::sim
