#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>
#include <set>
#include <sstream>

#include "firmware/base/command_line.h"
#include "firmware/control/types/settings.h"
#include "firmware/model/gjk.h"
#include "firmware/model/kinematics.h"
#include "firmware/model/load/load_arm.h"
#include "firmware/model/load/srdf.h"

namespace sidestep {
namespace {

constexpr double kLargeExcess_m = 0.03;
constexpr double kLargeShare = 0.05;  // of the configurations without contact, forbidden
constexpr double kShortShape_m = 1e-3;

struct Arguments {
  std::string urdf, base, tip;
  MeshOptions meshes;
  bool forward_kinematics = false, self_clearance = false;
};

const char* unit_of(const Arm& arm, int joint) {
  return arm.prismatic[static_cast<size_t>(joint)] ? "m" : "rad";
}

void print_joints(const Arm& arm) {
  fmt::print("{} joints\n  {:<24} {:>9} {:>9} {:>8} {:>8}\n", arm.joints, "", "lower", "upper", "speed", "reach");
  for (int i = 0; i < arm.joints; ++i)
    fmt::print("  {:<24} {:>9.4g} {:>9.4g} {:>8.4g} {:>8.3g}  {}\n", arm.joint_names[static_cast<size_t>(i)],
               arm.limits.lower_rad[i], arm.limits.upper_rad[i], arm.limits.velocity_radps[i],
               arm.joint_placement[static_cast<size_t>(i) + 1].translation().norm(), unit_of(arm, i));
  fmt::print("  (rad and rad/s, m and m/s for a prismatic joint; reach: distance from the joint before, m)\n");
}

std::string kind_of(const LinkShape& shape) {
  if (shape.is_capsule) return shape.capsule_body.is_sphere() ? "sphere" : "capsule";
  if (shape.solid.kind == CoreKind::kBox) return "box";
  return shape.solid.kind == CoreKind::kCylinder ? "cylinder" : "piece of a mesh";
}

void print_shapes(const Arm& arm) {
  size_t width = 24;
  for (const LinkShape& shape : arm.shapes) width = std::max(width, shape.link.size());
  fmt::print("{} shapes\n  {:<{}} {:>5} {:>8} {:>8} {:>8} {:>8}  {}\n", arm.shapes.size(), "", width, "body", "radius",
             "length", "excess", "largest", "kind");
  for (const LinkShape& shape : arm.shapes) {
    const Capsule& capsule = shape.capsule_body;
    const bool is_piece = shape.solid.kind == CoreKind::kPolyhedron && !shape.is_capsule;
    const auto excess = [&](double m) { return is_piece ? fmt::format("{:.4f}", m) : "-"; };
    fmt::print("  {:<{}} {:>5} {:>8.4f} {:>8.4f} {:>8} {:>8}  {}\n", shape.link, width, shape.body, capsule.radius_m,
               (capsule.end - capsule.start).norm(), excess(shape.excess_p95_m), excess(shape.excess_m),
               kind_of(shape));
  }
  fmt::print(
      "  (m; radius and length of the enclosing capsule; excess: from the surface of a mesh's pieces to the mesh, "
      "for 95 % of it and at most)\n");
}

std::vector<std::string> odd_joints(const Arm& arm) {
  std::vector<std::string> odd;
  for (int i = 0; i < arm.joints; ++i) {
    const std::string& name = arm.joint_names[static_cast<size_t>(i)];
    const double range_rad = arm.limits.upper_rad[i] - arm.limits.lower_rad[i], scale = arm.joint_scale[i];
    const char* unit = unit_of(arm, i);
    if (std::isinf(range_rad)) odd.push_back(fmt::format("joint '{}' is continuous: it has no position limits", name));
    if (range_rad < 0.1 * scale)
      odd.push_back(fmt::format("joint '{}' can only move {:.3g} {}", name, range_rad, unit));
    if (arm.limits.velocity_radps[i] > 10.0 * scale)
      odd.push_back(fmt::format("joint '{}' may move at {:.3g} {}/s", name, arm.limits.velocity_radps[i], unit));
    if (arm.limits.lower_rad[i] > 0.0 || arm.limits.upper_rad[i] < 0.0)
      odd.push_back(fmt::format("joint '{}' cannot be at 0", name));
  }
  return odd;
}

/// Pieces much larger than their mesh, tiny shapes, and links that overlap by design.
std::vector<std::string> odd_shapes(const Arm& arm, const SelfPairs& pairs) {
  std::vector<std::string> odd;
  std::map<std::string, double> large;
  for (const LinkShape& shape : arm.shapes) {
    const Capsule& capsule = shape.capsule_body;
    if (shape.excess_m > kLargeExcess_m) large[shape.link] = std::max(large[shape.link], shape.excess_m);
    if (2.0 * capsule.radius_m + (capsule.end - capsule.start).norm() < kShortShape_m)
      odd.push_back(fmt::format("link '{}' has a shape smaller than {:g} m", shape.link, kShortShape_m));
  }
  for (const auto& [link, excess_m] : large)
    odd.push_back(fmt::format("link '{}': its pieces extend {:.3f} m beyond the mesh", link, excess_m));
  if (pairs.forbidden_share > kLargeShare && pairs.worst >= 0) {
    const SelfPair& worst = pairs.kept[static_cast<size_t>(pairs.worst)];
    odd.push_back(fmt::format(
        "{:.0f} % of the configurations without contact are forbidden, {:.0f} % by links '{}' and "
        "'{}' (robot.ignore_pairs)",
        100.0 * pairs.forbidden_share, 100.0 * pairs.worst_share, arm.shapes[static_cast<size_t>(worst.first)].link,
        arm.shapes[static_cast<size_t>(worst.second)].link));
  }
  std::set<LinkPair> overlapping;
  for (const auto& [a, b] : pairs.overlaps)
    overlapping.emplace(arm.shapes[static_cast<size_t>(a)].link, arm.shapes[static_cast<size_t>(b)].link);
  for (const auto& [a, b] : overlapping)
    odd.push_back(fmt::format("links '{}' and '{}' overlap by design: parts of them are not kept apart", a, b));
  return odd;
}

/// Calls print with the poses of the links for every line of joint positions on standard input.
template <typename Print>
void for_each_configuration(const Arm& arm, Print print) {
  JointVector q_rad(arm.joints);
  std::string line, more;
  for (int number = 1; std::getline(std::cin, line); ++number) {
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    std::istringstream stream(line);
    for (double& angle_rad : q_rad) stream >> angle_rad;
    if (!stream || stream >> more)
      throw std::runtime_error(fmt::format("standard input, line {}: not {} joint positions", number, arm.joints));
    print(forward_kinematics(arm, q_rad));
  }
}

/// The pose of the tip: x y z, then the rotation by rows.
void print_pose(const LinkPoses& poses) {
  const Matrix3& r = poses.tool_rotation;
  fmt::print("{:.17g} {:.17g} {:.17g}", poses.tool_position.x(), poses.tool_position.y(), poses.tool_position.z());
  for (int row = 0; row < 3; ++row) fmt::print(" {:.17g} {:.17g} {:.17g}", r(row, 0), r(row, 1), r(row, 2));
  fmt::print("\n");
}

/// Of the kept pair that is nearest to its clearance: the distance less the clearance, the distance, the links.
void print_nearest_pair(const Arm& arm, const std::vector<SelfPair>& pairs, const LinkPoses& poses) {
  double least_m = HUGE_VAL, distance_m = HUGE_VAL;
  std::string links = "-";
  for (const SelfPair& pair : pairs) {
    const LinkShape& one = arm.shapes[static_cast<size_t>(pair.first)];
    const LinkShape& other = arm.shapes[static_cast<size_t>(pair.second)];
    const ConvexSolid a = solid_of(poses, one), b = solid_of(poses, other);
    const double found_m = gap_between(a, b, a.centre - b.centre).distance_m;
    if (found_m - pair.clearance_m >= least_m) continue;
    least_m = found_m - pair.clearance_m;
    distance_m = found_m;
    links = one.link + " " + other.link;
  }
  fmt::print("{:.6f} {:.6f} {}\n", least_m, distance_m, links);
}

void describe(CommandLine& app, Arguments& arguments) {
  app.add_option("urdf", arguments.urdf, "robot description").required();
  app.add_option("--base", arguments.base, "base link").required();
  app.add_option("--tip", arguments.tip, "tip link, the tool").required();
  app.add_option("--package-path", arguments.meshes.package_path, "folder that is searched first for package://")
      .one_value_at_a_time();
  app.add_option("--pieces-per-mesh", arguments.meshes.pieces_per_mesh, "most convex pieces for one mesh (default 8)")
      .range(1, 8);
  app.add_flag("--fk", arguments.forward_kinematics,
               "read joint positions from standard input, write poses of the tip: x y z and the rotation by rows");
  app.add_flag("--self", arguments.self_clearance,
               "read joint positions from standard input, write the distance of two links less its clearance, where "
               "that is least, the distance, and their names; less than 0 is forbidden");
  app.footer("Exit codes: 0 nothing odd, 1 something odd, 2 the controller would refuse the arm.");
}

int run(const Arguments& arguments) {
  const Arm arm = load_arm(arguments.urdf, arguments.base, arguments.tip, arguments.meshes);
  if (arguments.forward_kinematics) {
    for_each_configuration(arm, print_pose);
    return 0;
  }
  const std::string srdf = srdf_beside(arguments.urdf);
  const SelfPairs pairs = find_self_pairs(arm, ShieldSettings{}.self_clearance_m,
                                          srdf.empty() ? std::vector<LinkPair>() : disabled_collisions(srdf));
  if (arguments.self_clearance) {
    for_each_configuration(arm, [&](const LinkPoses& poses) { print_nearest_pair(arm, pairs.kept, poses); });
    return 0;
  }
  print_joints(arm);
  print_shapes(arm);
  fmt::print(
      "pairs of shapes that are kept apart from each other: {}; they forbid {:.1f} % of the configurations without "
      "contact\n",
      pairs.kept.size(), 100.0 * pairs.forbidden_share);
  check_limits(arm);
  std::vector<std::string> odd;
  for (const auto& remarks : {arm.remarks, arm.warnings, odd_joints(arm), odd_shapes(arm, pairs)})
    for (const std::string& remark : remarks)  // each once: several shapes of two links may overlap
      if (std::find(odd.begin(), odd.end(), remark) == odd.end()) odd.push_back(remark);
  for (const std::string& remark : odd) fmt::print("odd: {}\n", remark);
  return odd.empty() ? 0 : 1;
}

}  // namespace
}  // namespace sidestep

int main(int argc, char** argv) {
  sidestep::CommandLine app{
      "Shows how the controller reads a URDF: joints, limits, the shapes of the links, and oddities."};
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
