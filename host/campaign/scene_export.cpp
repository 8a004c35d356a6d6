#include "host/campaign/scene_export.h"

#include <fmt/format.h>

#include <charconv>
#include <functional>
#include <stdexcept>

#include "host/campaign/scene_maker.h"

namespace sidestep::campaign {
namespace {

constexpr double kWaypointPeriod_s = 0.05;
constexpr double kTurn_s = 1e-3;  // a box that reverses has its old velocity until so long before, its new one from so
                                  // long after

std::string list(const Eigen::Ref<const Eigen::VectorXd>& values) {
  std::string text;
  for (double value : values) text += fmt::format("{}{}", text.empty() ? "" : ", ", value);
  return '[' + text + ']';
}

std::string quaternion(const Eigen::Quaterniond& q) {
  return list(Eigen::Vector4d(q.w(), q.x(), q.y(), q.z()));
}

std::string start_of(const PointMotion& start) {
  return fmt::format("position_m: {}, velocity_mps: {}", list(start.position_m), list(start.velocity_mps));
}

std::string waypoint(double t_s, const PointMotion& point) {
  Eigen::Matrix<double, 7, 1> values;
  values << t_s, point.position_m, point.velocity_mps;
  return list(values);
}

/// Position and velocity at t = 0 and, unless straight, waypoints [t, position, velocity] until the end.
std::string motion(const Scene& scene, bool straight, const std::function<PointMotion(double)>& at) {
  std::string text = start_of(at(0.0));
  if (straight) return text;
  text += ",\n    waypoints: [";
  for (int k = 1; (k - 1) * kWaypointPeriod_s < scene.duration_s(); ++k) {
    const double t_s = k * kWaypointPeriod_s;
    text += fmt::format("{}\n      {}", k == 1 ? "" : ",", waypoint(t_s, at(t_s)));
  }
  return text + ']';
}

std::string target_yaml(const Scene& scene) {
  if (scene.family->posture) return fmt::format("{{joints_rad: {}}}", list(scene.goal_rad));
  std::string text = motion(scene, !scene.family->chase, [&](double t_s) { return target_at(scene, t_s); });
  if (scene.family->hold_orientation || scene.goal_has_orientation)
    text += ", quaternion: " + quaternion(orientation_target_at(scene, 0.0)->orientation);
  return '{' + text + '}';
}

/// Waypoints around each turn, between which the simulator's box reverses; elsewhere its motion is the same.
std::string box_motion(const Scene& scene, const BoxPath& box) {
  std::string waypoints;
  for (const double turn_s : box.turns_s(scene.duration_s()))
    for (const double t_s : {turn_s - kTurn_s, turn_s + kTurn_s})
      if (t_s > 0.0) waypoints += (waypoints.empty() ? "\n      " : ",\n      ") + waypoint(t_s, box.at(t_s));
  return start_of(box.at(0.0)) + (waypoints.empty() ? "" : ",\n    waypoints: [" + waypoints + ']');
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
  size_t id = scene.spheres.size();
  for (const BoxPath& box : scene.boxes)
    text += fmt::format("  - {{id: {}, {}, {}, quaternion: [1, 0, 0, 0]}}\n", id++,
                        to_yaml(sim::Solid{sim::Shape::kBox, Vector3::Constant(kBoxEdge_m)}), box_motion(scene, box));
  for (const sim::Obstacle& solid : scene.furniture) text += solid_yaml(solid, id + static_cast<size_t>(solid.id));
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
  // In the benchmark the trial among boxes ends when the goal is reached; here boxes may drive the arm away again.
  if (family.boxes) return text + "expect: {clearance_min_m: 0}\n";
  return text + fmt::format("expect: {{clearance_min_m: 0, final_distance_max_m: {}}}\n", arrived_within_m(family));
}

}  // namespace sidestep::campaign
