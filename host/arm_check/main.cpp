#include <fmt/format.h>

#include <cmath>
#include <iostream>
#include <map>
#include <sstream>

#include "firmware/base/command_line.h"
#include "firmware/control/types/settings.h"
#include "firmware/model/kinematics.h"
#include "firmware/model/load/load_arm.h"
#include "firmware/model/load/self_pairs.h"

namespace sidestep {
namespace {

constexpr double kLargeSlack_m = 0.05;
constexpr double kShortShape_m = 1e-3;

struct Arguments {
  std::string urdf, base, tip;
  MeshOptions meshes;
  bool forward_kinematics = false;
};

void print_joints(const Arm& arm) {
  fmt::print("{} joints\n  {:<24} {:>9} {:>9} {:>8} {:>8}\n", arm.joints, "", "lower", "upper", "speed", "reach");
  for (int i = 0; i < arm.joints; ++i)
    fmt::print("  {:<24} {:>9.4g} {:>9.4g} {:>8.4g} {:>8.3g}\n", arm.joint_names[static_cast<size_t>(i)],
               arm.limits.lower_rad[i], arm.limits.upper_rad[i], arm.limits.velocity_radps[i],
               arm.joint_placement[static_cast<size_t>(i) + 1].translation().norm());
  fmt::print("  (rad, rad, rad/s; reach: distance from the joint before, m)\n");
}

void print_shapes(const Arm& arm) {
  fmt::print("{} capsules\n  {:<24} {:>5} {:>8} {:>8} {:>8}\n", arm.shapes.size(), "", "body", "radius", "length",
             "slack");
  for (const LinkShape& shape : arm.shapes) {
    const Capsule& capsule = shape.capsule_body;
    const std::string slack = shape.slack_m > 0.0 ? fmt::format("{:.4f}", shape.slack_m) : "-";
    fmt::print("  {:<24} {:>5} {:>8.4f} {:>8.4f} {:>8}\n", shape.link, shape.body, capsule.radius_m,
               (capsule.end - capsule.start).norm(), slack);
  }
  fmt::print("  (m; slack: largest distance from a mesh to the surface of its capsules)\n");
}

std::vector<std::string> odd_joints(const Arm& arm) {
  std::vector<std::string> odd;
  for (int i = 0; i < arm.joints; ++i) {
    const std::string& name = arm.joint_names[static_cast<size_t>(i)];
    const double range_rad = arm.limits.upper_rad[i] - arm.limits.lower_rad[i];
    if (std::isinf(range_rad)) odd.push_back(fmt::format("joint '{}' is continuous: it has no position limits", name));
    if (range_rad < 0.1) odd.push_back(fmt::format("joint '{}' can only move {:.3g} rad", name, range_rad));
    if (arm.limits.velocity_radps[i] > 10.0)
      odd.push_back(fmt::format("joint '{}' may turn at {:.3g} rad/s", name, arm.limits.velocity_radps[i]));
    if (arm.limits.lower_rad[i] > 0.0 || arm.limits.upper_rad[i] < 0.0)
      odd.push_back(fmt::format("joint '{}' cannot be at 0", name));
  }
  return odd;
}

/// Capsules much larger than their mesh, tiny shapes, and links that overlap by design.
std::vector<std::string> odd_shapes(const Arm& arm) {
  std::vector<std::string> odd;
  std::map<std::string, double> large;
  for (const LinkShape& shape : arm.shapes) {
    const Capsule& capsule = shape.capsule_body;
    if (shape.slack_m > kLargeSlack_m) large[shape.link] = shape.slack_m;
    if (2.0 * capsule.radius_m + (capsule.end - capsule.start).norm() < kShortShape_m)
      odd.push_back(fmt::format("link '{}' has a shape smaller than {:g} m", shape.link, kShortShape_m));
  }
  for (const auto& [link, slack_m] : large)
    odd.push_back(
        fmt::format("link '{}': its capsules extend {:.3f} m beyond the mesh; try --capsules-per-mesh 4 "
                    "(robot.capsules_per_mesh in a configuration)",
                    link, slack_m));
  for (const auto& [a, b] : find_overlaps(arm, ShieldSettings{}.self_clearance_m))
    odd.push_back(fmt::format("links '{}' and '{}' overlap by design: they are not kept apart",
                              arm.shapes[static_cast<size_t>(a)].link, arm.shapes[static_cast<size_t>(b)].link));
  return odd;
}

/// Prints the pose of the tip (x y z, then the rotation by rows) for every line of joint positions on standard input.
void print_poses(const Arm& arm) {
  JointVector q_rad(arm.joints);
  std::string line, more;
  for (int number = 1; std::getline(std::cin, line); ++number) {
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    std::istringstream stream(line);
    for (double& angle_rad : q_rad) stream >> angle_rad;
    if (!stream || stream >> more)
      throw std::runtime_error(fmt::format("standard input, line {}: not {} joint positions", number, arm.joints));
    const LinkPoses poses = forward_kinematics(arm, q_rad);
    const Matrix3& r = poses.tool_rotation;
    fmt::print("{:.17g} {:.17g} {:.17g}", poses.tool_position.x(), poses.tool_position.y(), poses.tool_position.z());
    for (int row = 0; row < 3; ++row) fmt::print(" {:.17g} {:.17g} {:.17g}", r(row, 0), r(row, 1), r(row, 2));
    fmt::print("\n");
  }
}

void describe(CommandLine& app, Arguments& arguments) {
  app.add_option("urdf", arguments.urdf, "robot description").required();
  app.add_option("--base", arguments.base, "base link").required();
  app.add_option("--tip", arguments.tip, "tip link, the tool").required();
  app.add_option("--package-path", arguments.meshes.package_path, "folder that is searched first for package://")
      .one_value_at_a_time();
  app.add_option("--capsules-per-mesh", arguments.meshes.capsules_per_mesh, "most capsules for one mesh (default 3)")
      .range(1, 8);
  app.add_flag("--fk", arguments.forward_kinematics,
               "read joint positions from standard input, write poses of the tip: x y z and the rotation by rows");
  app.footer("Exit codes: 0 nothing odd, 1 something odd, 2 the controller would refuse the arm.");
}

int run(const Arguments& arguments) {
  const Arm arm = load_arm(arguments.urdf, arguments.base, arguments.tip, arguments.meshes);
  if (arguments.forward_kinematics) {
    print_poses(arm);
    return 0;
  }
  print_joints(arm);
  print_shapes(arm);
  fmt::print("{} pairs of capsules are kept apart from each other\n",
             find_self_pairs(arm, ShieldSettings{}.self_clearance_m).size());
  check_limits(arm);
  std::vector<std::string> odd = arm.remarks;
  for (const auto& more : {odd_joints(arm), odd_shapes(arm)}) odd.insert(odd.end(), more.begin(), more.end());
  for (const std::string& remark : odd) fmt::print("odd: {}\n", remark);
  return odd.empty() ? 0 : 1;
}

}  // namespace
}  // namespace sidestep

int main(int argc, char** argv) {
  sidestep::CommandLine app{
      "Shows how the controller reads a URDF: joints, limits, the capsules around the links, and oddities."};
  sidestep::Arguments arguments;
  sidestep::describe(app, arguments);
  try {
    if (const auto exit_code = app.parse(argc, argv)) return *exit_code;
    return sidestep::run(arguments);
  } catch (const std::exception& error) {
    std::cerr << "arm-check: " << error.what() << "\n";
    return 2;
  }
}
