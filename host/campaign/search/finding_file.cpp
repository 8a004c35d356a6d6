#include "host/campaign/search/finding_file.h"

#include <fmt/format.h>

#include <fstream>
#include <stdexcept>

#include "firmware/io/config/yaml_section.h"

namespace sidestep::campaign {
namespace {

constexpr NumberRange kLength{-10.0, 10.0}, kTime{0.0, kLongestSearchScene_s}, kAngle{-100.0, 100.0};
constexpr int kJoints = 7;

std::string list(const Eigen::Ref<const Eigen::VectorXd>& values) {
  std::string text;
  for (double value : values) text += fmt::format("{}{}", text.empty() ? "" : ", ", value);
  return '[' + text + ']';
}

std::string to_yaml(const MovingCapsule& obstacle) {
  return fmt::format("{{radius_m: {}, half_axis_m: {}, crossing_m: {}, crossing_s: {}, velocity_mps: {}}}",
                     obstacle.radius_m, list(obstacle.half_axis_m), list(obstacle.crossing_m), obstacle.crossing_s,
                     list(obstacle.velocity_mps));
}

std::string to_yaml(const WitnessPath::Segment& segment) {
  return fmt::format("{{begin_s: {}, duration_s: {}, knot_rad: {}}}", segment.begin_s, segment.duration_s,
                     list(segment.knot_rad));
}

template <typename Item>
std::string to_yaml(const std::vector<Item>& items) {
  std::string text;
  for (const Item& item : items) text += (text.empty() ? "" : ", ") + to_yaml(item);
  return '[' + text + ']';
}

MovingCapsule read_obstacle(YamlSection& section) {
  MovingCapsule obstacle{section.number("radius_m", {1e-3, 1.0}), section.vector("half_axis_m", kLength),
                         section.vector("crossing_m", kLength), section.number("crossing_s", kTime),
                         section.vector("velocity_mps", kLength)};
  if (obstacle.velocity_mps.norm() < kLeastSpeed_mps) section.fail("velocity_mps", "is too slow to pass");
  section.finish();
  return obstacle;
}

WitnessPath::Segment read_segment(YamlSection& section) {
  WitnessPath::Segment segment{section.number("begin_s", {0.0, 100.0}), section.number("duration_s", {1e-3, 100.0}),
                               section.numbers("knot_rad", kJoints, kJoints, kAngle)};
  section.finish();
  return segment;
}

}  // namespace

std::string to_yaml(const SearchScene& scene, const WitnessPath& witness) {
  return fmt::format("{{family: {}, start_rad: {}, obstacles: {}, witness: {}}}", name_of(scene.family),
                     list(scene.start_rad), to_yaml(scene.obstacles), to_yaml(witness.segments));
}

ProvenScene load_proven_scene(const std::string& file) {
  YamlSection root = YamlSection::of_file(file);
  SearchScene scene{search_family_named(root.choice("family", {"rest", "track"})),
                    root.numbers("start_rad", kJoints, kJoints, kAngle),
                    {}};
  for (YamlSection& obstacle : root.sections("obstacles")) scene.obstacles.push_back(read_obstacle(obstacle));
  if (scene.obstacles.empty()) root.fail("obstacles", "at least one");
  WitnessPath witness{scene.start_rad, {}};
  for (YamlSection& segment : root.sections("witness")) witness.segments.push_back(read_segment(segment));
  root.finish();
  return {scene, witness};
}

void write_findings(const std::string& file, const std::string& law, const std::vector<Finding>& findings) {
  std::ofstream stream(file);
  stream << "family,law,obstacles,chain,run,clearance_m,time_s,witness_clearance_m,scene\n";
  for (const Finding& finding : findings)
    stream << fmt::format("{},{},{},{},{},{},{},{},\"{}\"\n", name_of(finding.scene.family), law,
                          finding.scene.obstacles.size(), finding.chain, finding.run, finding.closest.clearance_m,
                          finding.closest.t_s, finding.witness_clearance_m, to_yaml(finding.scene, finding.witness));
  stream.close();
  if (!stream) throw std::runtime_error(fmt::format("{}: cannot be written", file));
}

}  // namespace sidestep::campaign
