#include "host/campaign/problems/problem_files.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "firmware/base/fail.h"

namespace sidestep::campaign {
namespace {

using std::filesystem::path;
using Positions = std::map<std::string, double>;

Vector3 vector_of(const YAML::Node& node) {
  return {node[0].as<double>(), node[1].as<double>(), node[2].as<double>()};
}

Eigen::Isometry3d pose_of(const YAML::Node& node, const char* translation, const char* rotation) {
  const YAML::Node& xyzw = node[rotation];
  const Quaternion q(xyzw[3].as<double>(), xyzw[0].as<double>(), xyzw[1].as<double>(), xyzw[2].as<double>());
  return Eigen::Translation3d(vector_of(node[translation])) * q.normalized();
}

sim::Solid solid_of(const YAML::Node& primitive) {
  const std::string type = primitive["type"].as<std::string>();
  const YAML::Node& size = primitive["dimensions"];
  if (type == "box") return {sim::Shape::kBox, vector_of(size)};
  // MoveIt gives the height before the radius.
  if (type == "cylinder") return {sim::Shape::kCylinder, {size[1].as<double>(), size[0].as<double>(), 0.0}};
  if (type == "sphere") return {sim::Shape::kSphere, {size[0].as<double>(), 0.0, 0.0}};
  fail("a primitive of type '{}', which is no box, cylinder or sphere", type);
}

void read_object(const YAML::Node& object, std::vector<sim::Obstacle>& obstacles) {
  if (object["meshes"] && object["meshes"].size() > 0)
    fail("the object '{}' is a mesh", object["id"].as<std::string>());
  const Eigen::Isometry3d base_from_object =
      object["pose"] ? pose_of(object["pose"], "position", "orientation") : Eigen::Isometry3d::Identity();
  for (size_t i = 0; i < object["primitives"].size(); ++i) {
    const Eigen::Isometry3d pose = base_from_object * pose_of(object["primitive_poses"][i], "position", "orientation");
    sim::Obstacle obstacle;
    obstacle.id = static_cast<int32_t>(obstacles.size());
    obstacle.solid = solid_of(object["primitives"][i]);
    obstacle.motion.position_m = pose.translation();
    obstacle.motion.orientation = Quaternion(pose.linear());
    obstacles.push_back(obstacle);
  }
}

Positions start_of(const YAML::Node& request) {
  const YAML::Node& state = request["start_state"]["joint_state"];
  Positions positions;
  for (size_t i = 0; i < state["name"].size(); ++i)
    positions[state["name"][i].as<std::string>()] = state["position"][i].as<double>();
  return positions;
}

Positions goal_of(const YAML::Node& request) {
  Positions positions;
  for (const YAML::Node& constraint : request["goal_constraints"][0]["joint_constraints"])
    positions[constraint["joint_name"].as<std::string>()] = constraint["position"].as<double>();
  return positions;
}

/// The arm's joints in their order, removed from `positions`. Rounded values may lie just outside the limits.
Joints take_joints(const Arm& arm, const char* what, Positions& positions) {
  Joints q_rad(arm.joints);
  for (int i = 0; i < arm.joints; ++i) {
    const std::string& joint = arm.joint_names[static_cast<size_t>(i)];
    if (positions.count(joint) == 0) fail("the {} has no position of {}", what, joint);
    q_rad[i] = std::clamp(positions.at(joint), arm.limits.lower_rad[i], arm.limits.upper_rad[i]);
    positions.erase(joint);
  }
  return q_rad;
}

template <typename Read>
void read_file(const path& file, const Read& read) {
  try {
    read(YAML::LoadFile(file.string()));
  } catch (const std::exception& error) {
    fail("{}: {}", file.string(), error.what());
  }
}

Problem read_problem(const path& scene, const path& request, const Arm& arm) {
  Problem problem;
  problem.kind = scene.parent_path().filename().string();
  problem.name = scene.stem().string().substr(5);
  read_file(scene, [&](const YAML::Node& node) {
    for (const YAML::Node& object : node["world"]["collision_objects"]) read_object(object, problem.obstacles);
  });
  read_file(request, [&](const YAML::Node& node) {
    Positions start = start_of(node), goal = goal_of(node);
    problem.start_rad = take_joints(arm, "start", start);
    problem.goal_rad = take_joints(arm, "goal", goal);
    problem.other_positions = start;
  });
  return problem;
}

}  // namespace

std::vector<Problem> read_problems(const std::string& folder, const Arm& arm) {
  if (!std::filesystem::is_directory(folder)) fail("{}: no such folder", folder);
  std::vector<Problem> problems;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (name.rfind("scene", 0) != 0 || entry.path().extension() != ".yaml") continue;
    const path request = entry.path().parent_path() / ("request" + name.substr(5));
    problems.push_back(read_problem(entry.path(), request, arm));
  }
  if (problems.empty()) fail("{}: holds no scene<number>.yaml", folder);
  std::sort(problems.begin(), problems.end(),
            [](const Problem& a, const Problem& b) { return std::pair(a.kind, a.name) < std::pair(b.kind, b.name); });
  return problems;
}

}  // namespace sidestep::campaign
