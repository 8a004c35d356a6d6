#include "host/campaign/scene_export.h"

#include <fmt/format.h>

#include <charconv>
#include <functional>
#include <stdexcept>

#include "host/campaign/scene_maker.h"

namespace sidestep::campaign {
namespace {

constexpr double kWaypointPeriod_s = 0.05;

std::string list(const Eigen::Ref<const Eigen::VectorXd>& values) {
  std::string text;
  for (double value : values) text += fmt::format("{}{}", text.empty() ? "" : ", ", value);
  return '[' + text + ']';
}

std::string quaternion(const Eigen::Quaterniond& q) {
  return list(Eigen::Vector4d(q.w(), q.x(), q.y(), q.z()));
}

/// Position and velocity at t = 0 and, unless straight, waypoints [t, position, velocity] until the end.
std::string motion(const Scene& scene, bool straight, const std::function<PointMotion(double)>& at) {
  const PointMotion start = at(0.0);
  std::string text = fmt::format("position_m: {}, velocity_mps: {}", list(start.position_m), list(start.velocity_mps));
  if (straight) return text;
  text += ",\n    waypoints: [";
  for (int k = 1; (k - 1) * kWaypointPeriod_s < scene.duration_s(); ++k) {
    const PointMotion point = at(k * kWaypointPeriod_s);
    Eigen::Matrix<double, 7, 1> values;
    values << k * kWaypointPeriod_s, point.position_m, point.velocity_mps;
    text += fmt::format("{}\n      {}", k == 1 ? "" : ",", list(values));
  }
  return text + ']';
}

std::string target_yaml(const Scene& scene) {
  std::string text = motion(scene, !scene.family->chase, [&](double t_s) { return target_at(scene, t_s); });
  if (scene.family->hold_orientation || scene.goal_has_orientation)
    text += ", quaternion: " + quaternion(orientation_target_at(scene, 0.0)->orientation);
  return '{' + text + '}';
}

std::string solid_yaml(const sim::Obstacle& solid, size_t id) {
  return fmt::format("  - {{id: {}, {}, position_m: {}, velocity_mps: [0, 0, 0], quaternion: {}}}\n", id,
                     to_yaml(solid.solid), list(solid.motion.position_m), quaternion(solid.motion.orientation));
}

std::string obstacles_yaml(const Scene& scene) {
  std::string text;
  for (size_t i = 0; i < scene.spheres.size(); ++i) {
    const SpherePath& sphere = scene.spheres[i];
    text += fmt::format("  - {{id: {}, shape: sphere, radius_m: {}, {}}}\n", i, kSphereRadius_m,
                        motion(scene, sphere.straight(), [&](double t_s) { return sphere.at(t_s); }));
  }
  for (const sim::Obstacle& solid : scene.furniture)
    text += solid_yaml(solid, scene.spheres.size() + static_cast<size_t>(solid.id));
  return text;
}

std::string plant_yaml(const Scene& scene) {
  if (!scene.family->real) return "{kind: ideal}";
  const Limits limits = scene.arm->limits(*scene.family);
  return fmt::format(
      "{{kind: servo, lag_s: {}, latency_s: 0, velocity_limit_radps: {}, acceleration_limit_radps2: {}}}", kPlantLag_s,
      list(limits.velocity_radps), kPlantAcceleration_radps2);
}

}  // namespace

Scene scene_to_export(const std::string& name, const JudgeArm& arm) {
  const size_t colon = name.find(':');
  if (colon != std::string::npos) {
    uint64_t seed = 0;
    const char* end = name.data() + name.size();
    const auto [rest, error] = std::from_chars(name.data() + colon + 1, end, seed);
    if (error == std::errc() && rest == end) return make_scene(family_named(name.substr(0, colon)), seed, arm);
  }
  throw std::runtime_error(fmt::format("--replay: '{}' must be FAMILY:SEED", name));
}

std::string export_scene(const Scene& scene) {
  const Family& family = *scene.family;
  if (family.full_pose)
    throw std::runtime_error("--replay: a scenario cannot describe the orientation of a full-pose family's target");
  if (family.has_people()) throw std::runtime_error("--replay: a scenario cannot describe the motion of a person");
  std::string text = fmt::format("# Written by: build/campaign --replay {}:{}\n", family.name, scene.seed);
  if (family.real)
    text += "# In the benchmark the obstacle messages are noisy, late and incomplete; here they are exact.\n";
  text += fmt::format("title: \"Benchmark, {} {}\"\n", family.name, scene.seed);
  const ArmSource arm = scene.arm->source(family);
  text += fmt::format("robot: {{urdf: {}, base: {}, tip: {}}}\n", arm.urdf, arm.base, arm.tip);
  text += fmt::format("config: {}\n", arm.config.empty() ? "none" : arm.config);
  text += fmt::format("duration_s: {:.2f}\nrate_hz: 100\n", scene.duration_s());
  text += fmt::format("start_rad: {}\nplant: {}\n", list(scene.start_rad), plant_yaml(scene));
  text += fmt::format("target: {}\nobstacles:\n{}", target_yaml(scene), obstacles_yaml(scene));
  return text + fmt::format("expect: {{clearance_min_m: 0, final_distance_max_m: {}}}\n", arrived_within_m(family));
}

}  // namespace sidestep::campaign
