#include "firmware/io/config/config.h"

#include <fmt/format.h>

#include <limits>
#include <map>

#include "firmware/base/find_file.h"
#include "firmware/io/config/channel_section.h"
#include "firmware/io/config/surroundings.h"
#include "firmware/io/config/yaml_section.h"
#include "firmware/model/load/self_pairs.h"
#include "firmware/model/load/srdf.h"

namespace sidestep {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr NumberRange kAnyNumber{-kInfinity, kInfinity};  // check_limits() decides

// The ranges below hold every value that makes sense for an arm, and none that takes a protection away. Those of the
// paper's law, which has no protections, are wide, for experiments. They are documented in firmware/config/lwa3.yaml,
// which a test compares.

void read_limits(YamlSection limits, Arm& arm) {
  // One number for all joints is in rad: prismatic joints keep what the URDF says.
  const auto read = [&](const char* key, JointVector& values) {
    const JointVector of_urdf = values;
    limits.per_joint(key, arm.joints, values, kAnyNumber);
    if (!limits.is_list(key))
      for (int i = 0; i < arm.joints; ++i)
        if (arm.prismatic[i]) values[i] = of_urdf[i];
  };
  read("velocity_radps", arm.limits.velocity_radps);
  read("acceleration_radps2", arm.limits.acceleration_radps2);
  read("lower_rad", arm.limits.lower_rad);
  read("upper_rad", arm.limits.upper_rad);
  limits.finish();
  try {
    check_limits(arm);
  } catch (const std::exception& error) {
    limits.fail("", error.what());
  }
}

void read_paper(YamlSection paper, PaperGains& gains) {
  paper.number("k_pos_per_s2", gains.k_pos_per_s2, {0.0, 1e6});
  paper.number("k_vel_per_s", gains.k_vel_per_s, {0.0, 1e6});
  paper.number("k_rpos_m2ps2", gains.k_rpos_m2ps2, {0.0, 1e6});
  paper.number("k_rvel_m2ps2", gains.k_rvel_m2ps2, {0.0, 1e6});
  paper.number("rho_0_m", gains.rho_0_m, {0.0001, 1e6});
  paper.number("rho_v_m", gains.rho_v_m, {0.0001, 1e6});
  paper.number("rho_min_m", gains.rho_min_m, {0.0001, 1e6});
  paper.number("v_max_mps", gains.v_max_mps, {0.0001, 1e6});
  paper.number("lambda_0", gains.lambda_0, {0.0, 1e6});
  paper.number("sigma_0", gains.sigma_0, {0.0001, 1e6});
  paper.number("lambda_n", gains.lambda_n, {0.0001, 1e6});
  paper.number("x_m_mps", gains.x_m_mps, {0.0, 1e6});
  paper.number("d_m_m", gains.d_m_m, {0.0001, 1e6});
  paper.number("d_1_m", gains.d_1_m, {0.0001, 1e6});
  paper.number("d_2_m", gains.d_2_m, {0.0, 1e6});
  paper.number("k_ori_per_s", gains.k_ori_per_s, {0.0, 1e6});
  std::string tool_velocity = "measured";
  paper.choice("tool_velocity", tool_velocity, {"measured", "planned"});
  gains.tool_velocity = tool_velocity == "planned" ? ToolVelocity::kPlanned : ToolVelocity::kMeasured;
  if (gains.d_2_m >= gains.d_1_m) paper.fail("d_2_m", "must be below d_1_m");
  paper.finish();
}

void read_sidestep(YamlSection sidestep, SidestepGains& gains) {
  sidestep.number("k_pos_per_s", gains.k_pos_per_s, {0.1, 50.0});
  sidestep.number("k_ori_per_s", gains.k_ori_per_s, {0.1, 50.0});
  sidestep.number("k_posture_per_s", gains.k_posture_per_s, {0.0, 10.0});
  sidestep.number("k_guide_per_s", gains.k_guide_per_s, {0.1, 50.0});
  sidestep.number("guide_posture_share", gains.guide_posture_share, {0.0, 1.0});
  sidestep.number("v_max_mps", gains.v_max_mps, {0.01, 10.0});
  sidestep.number("lambda_0", gains.lambda_0, {0.0, 1.0});
  sidestep.number("sigma_0", gains.sigma_0, {0.001, 1.0});
  sidestep.finish();
}

void read_shield(YamlSection section, ShieldSettings& shield) {
  section.flag("enabled", shield.enabled);
  section.number("hard_clearance_m", shield.hard_clearance_m, {0.0, 0.5});
  section.number("rest_clearance_m", shield.rest_clearance_m, {0.0, 0.5});
  section.number("hard_gain_per_s", shield.hard_gain_per_s, {0.1, 100.0});
  section.number("pass_clearance_m", shield.pass_clearance_m, {0.0, 0.5});
  section.number("pass_gain_per_s", shield.pass_gain_per_s, {0.1, 100.0});
  section.number("pass_reaction_s", shield.pass_reaction_s, {0.0, 1.0});
  section.number("pass_horizon_s", shield.pass_horizon_s, {0.1, 10.0});
  section.number("comfort_clearance_m", shield.comfort_clearance_m, {0.0, 2.0});
  section.number("comfort_gain_per_s", shield.comfort_gain_per_s, {0.1, 100.0});
  section.number("comfort_weight", shield.comfort_weight, {0.001, 1e6});
  section.number("comfort_least_weight", shield.comfort_least_weight, {0.001, 1e6});
  section.number("person_clearance_m", shield.person_clearance_m, {0.0, 2.0});
  section.number("person_gain_per_s", shield.person_gain_per_s, {0.1, 100.0});
  section.number("person_weight", shield.person_weight, {0.0, 1e6});
  section.number("comfort_near_m", shield.comfort_near_m, {0.0, 5.0});
  section.number("comfort_far_m", shield.comfort_far_m, {0.01, 10.0});
  if (shield.comfort_far_m <= shield.comfort_near_m) section.fail("comfort_far_m", "must be above comfort_near_m");
  section.number("tool_weight", shield.tool_weight, {0.0, 10000.0});
  section.number("self_clearance_m", shield.self_clearance_m, {0.0, 0.5});
  section.number("range_m", shield.range_m, {0.1, 5.0});
  if (shield.pass_clearance_m <= shield.hard_clearance_m)
    section.fail("pass_clearance_m", "must be above hard_clearance_m");
  if (shield.range_m <= shield.pass_clearance_m) section.fail("range_m", "must be above pass_clearance_m");
  section.finish();
}

void read_timeouts(YamlSection section, Timeouts& timeouts) {
  section.renamed("old_place_s", "coast_s");
  section.number("target_s", timeouts.target_s, {0.01, 5.0});
  section.number("obstacles_s", timeouts.obstacles_s, {0.01, 1.0});
  section.number("arm_state_s", timeouts.arm_state_s, {0.005, 0.5});
  section.number("arm_state_lost_s", timeouts.arm_state_lost_s, {0.005, 1.0});
  section.number("consistent_s", timeouts.consistent_s, {0.1, 10.0});
  section.number("control_s", timeouts.control_s, {0.0, 10.0});
  section.number("coast_s", timeouts.coast_s, {0.0, 10.0});
  if (timeouts.arm_state_lost_s < timeouts.arm_state_s)
    section.fail("arm_state_lost_s", "must not be below arm_state_s");
  section.finish();
}

constexpr double kLowestRate_hz = 10.0, kHighestRate_hz = 2000.0;

void read_control(YamlSection control, double rate_override_hz, Settings& settings) {
  control.number("rate_hz", settings.rate_hz, {kLowestRate_hz, kHighestRate_hz});
  if (rate_override_hz != 0.0) settings.rate_hz = rate_override_hz;
  if (!(settings.rate_hz >= kLowestRate_hz && settings.rate_hz <= kHighestRate_hz))
    control.fail("rate_hz", "must be from 10 to 2000 (also when given by --rate)");
  control.number("following_error_rad", settings.following_error_rad, {0.01, 1.0});
  control.finish();
}

void read_obstacles(YamlSection obstacles, Settings& settings) {
  obstacles.flag("wait_for_first", settings.wait_for_obstacles);
  obstacles.number("speed_bound_mps", settings.obstacle_speed_bound_mps, {0.1, 20.0});
  obstacles.number("latency_s", settings.obstacle_trust.latency_s, {0.0, 1.0});
  obstacles.number("uncertainty_m", settings.obstacle_trust.uncertainty_m, {0.0, 0.5});
  obstacles.number("acceleration_bound_mps2", settings.obstacle_trust.acceleration_bound_mps2, {0.0, 100.0});
  obstacles.finish();
}

/// Messages of two kinds on one channel could not be told apart, so every channel name must be unique.
void check_channels_are_unique(const YamlSection& root, const Config& config) {
  const Channels& channels = config.channels;
  const Neighbours& neighbours = config.neighbours;
  std::vector<std::pair<std::string, std::string>> names = {{"channels.target", channels.target},
                                                            {"channels.joint_target", channels.joint_target},
                                                            {"channels.obstacles", channels.obstacles},
                                                            {"channels.arm_state", channels.arm_state},
                                                            {"channels.other_joints", channels.other_joints},
                                                            {"channels.control", channels.control},
                                                            {"channels.attachments", channels.attachments},
                                                            {"channels.arm_command", channels.arm_command},
                                                            {"channels.controller_status", channels.controller_status},
                                                            {"channels.loop_timing", channels.loop_timing}};
  if (!neighbours.publish.empty()) names.emplace_back("neighbours.publish", neighbours.publish);
  for (const std::string& channel : neighbours.listen) names.emplace_back("neighbours.listen", channel);
  std::map<std::string, std::string> used;
  for (const auto& [key, name] : names)
    if (const auto [before, is_new] = used.emplace(name, key); !is_new)
      root.fail(key, fmt::format("'{}' is already the channel of {}", name, before->second));
}

void read_neighbours(YamlSection section, bool wait_for_obstacles, Neighbours& neighbours) {
  read_channel(section, "publish", neighbours.publish);
  section.texts("listen", neighbours.listen);
  if (neighbours.listen.size() > kMaxNeighbours) section.fail("listen", fmt::format("more than {}", kMaxNeighbours));
  for (const std::string& channel : neighbours.listen) check_channel_length(section, "listen", channel);
  if (!neighbours.listen.empty() && !wait_for_obstacles)
    section.fail("listen", "needs obstacles.wait_for_first: the arm waits for the links of all neighbours");
  neighbours.world_from_base = read_world_from_base(section);
  section.finish();
}

void read_blackbox(YamlSection section, BlackboxSettings& blackbox) {
  section.number("seconds", blackbox.seconds, {1.0, 60.0});
  section.text("folder", blackbox.folder);
  section.finish();
}

void read_foresight(YamlSection section, ForesightSettings& foresight) {
  section.flag("enabled", foresight.enabled);
  section.number("horizon_s", foresight.horizon_s, {0.5, 20.0});
  section.number("clearance_m", foresight.clearance_m, {0.0, 0.5});
  section.whole("seed", foresight.seed, {0.0, 1e9});
  section.finish();
}

void read_dialect(YamlSection& root, Config& config) {
  std::string name = kSidestepDialect.name;
  root.choice("dialect", name, dialect_names());
  const Dialect& dialect = dialect_named(name);
  const int joints = config.model.arm.joints;
  if (dialect.joints != 0 && dialect.joints != joints)
    root.fail("dialect", fmt::format("{} needs an arm with {} joints, this one has {}", name, dialect.joints, joints));
  config.dialect = &dialect;
  config.model.settings.start_guard_s = dialect.start_guard_s;
  config.channels.arm_state = dialect.arm_state_channel;
  config.channels.arm_command = dialect.arm_command_channel;
}

std::string find_urdf(const YamlSection& section, const std::string& name, const std::string& config_file) {
  std::string found = find_file(name, config_file);
  if (found.empty())
    section.fail("urdf",
                 fmt::format("there is no file '{}' in the folder of the configuration, in the working directory, "
                             "in a folder above these, or in share/sidestep",
                             name));
  return found;
}

Robot read_robot(YamlSection section, const std::string& config_file, const Overrides& overrides) {
  Robot robot;
  section.text("urdf", robot.urdf);
  section.text("base", robot.base);
  section.text("tip", robot.tip);
  section.texts("package_path", robot.meshes.package_path);
  section.renamed("capsules_per_mesh", "pieces_per_mesh");
  section.whole("pieces_per_mesh", robot.meshes.pieces_per_mesh, {1.0, 8.0});
  section.text("srdf", robot.srdf);
  std::vector<std::string> ignored;
  section.texts("ignore_pairs", ignored);
  for (const std::string& pair : ignored) {
    const size_t space = pair.find(' ');
    if (space == std::string::npos || pair.find(' ', space + 1) != std::string::npos)
      section.fail("ignore_pairs", fmt::format("'{}' is not two links with a space between them", pair));
    robot.ignored_pairs.emplace_back(pair.substr(0, space), pair.substr(space + 1));
  }
  robot.joint_positions = section.named_numbers("joint_positions", kAnyNumber);  // load_arm() decides
  section.finish();
  if (!overrides.urdf.empty()) robot.urdf = overrides.urdf;
  if (!overrides.base.empty()) robot.base = overrides.base;
  if (!overrides.tip.empty()) robot.tip = overrides.tip;
  if (robot.urdf.empty()) section.fail("urdf", "is missing (or give --urdf)");
  if (robot.base.empty()) section.fail("base", "is missing (or give --base)");
  if (robot.tip.empty()) section.fail("tip", "is missing (or give --tip)");
  if (overrides.urdf.empty()) robot.urdf = find_urdf(section, robot.urdf, config_file);
  if (robot.srdf.empty())
    robot.srdf = srdf_beside(robot.urdf);
  else if (const std::string found = find_file(robot.srdf, config_file); !found.empty())
    robot.srdf = found;
  return robot;
}

/// Pairs of links that the SRDF or the configuration exempts.
std::vector<LinkPair> ignored_pairs(const Robot& robot) {
  std::vector<LinkPair> pairs = robot.srdf.empty() ? std::vector<LinkPair>() : disabled_collisions(robot.srdf);
  pairs.insert(pairs.end(), robot.ignored_pairs.begin(), robot.ignored_pairs.end());
  return pairs;
}

std::vector<std::string> warnings_of(const Settings& settings, const Arm& arm, const JointLimits& of_urdf) {
  std::vector<std::string> warnings = arm.warnings;
  const auto warn_if = [&](bool is_off, std::string text) {
    if (is_off) warnings.push_back(std::move(text));
  };
  warn_if(!settings.shield.enabled, "shield.enabled is false: the arm avoids nothing");
  warn_if(!settings.foresight.enabled, "foresight.enabled is false: the arm may get stuck");
  warn_if(!settings.wait_for_obstacles,
          "obstacles.wait_for_first is false: the arm moves before it knows any obstacle");
  warn_if(settings.timeouts.coast_s == 0.0, "timeouts.coast_s is 0: an obstacle that is not reported is forgotten");
  for (int i = 0; i < arm.joints; ++i) {
    constexpr double kFastest_radps = 30.0, kSharpest_radps2 = 200.0;
    const double scale = arm.joint_scale[i], fastest = scale * kFastest_radps, sharpest = scale * kSharpest_radps2;
    const char* unit = arm.prismatic[i] ? "m" : "rad";
    warn_if(arm.limits.velocity_radps[i] > fastest || arm.limits.acceleration_radps2[i] > sharpest,
            fmt::format("limits: joint '{}' has a velocity limit above {:g} {}/s or an acceleration limit above {:g} "
                        "{}/s2, which limits nothing",
                        arm.joint_names[i], fastest, unit, sharpest, unit));
    warn_if(arm.limits.lower_rad[i] < of_urdf.lower_rad[i] || arm.limits.upper_rad[i] > of_urdf.upper_rad[i] ||
                arm.limits.velocity_radps[i] > of_urdf.velocity_radps[i],
            fmt::format("limits: joint '{}' may go beyond the limits of the URDF", arm.joint_names[i]));
  }
  return warnings;
}

}  // namespace

Config load_config(const std::string& file, const Overrides& overrides) {
  YamlSection root = file.empty() ? YamlSection::empty() : YamlSection::of_file(file);
  Config config;
  config.file = file;
  config.overrides = overrides;
  Settings& settings = config.model.settings;

  std::string law = "sidestep";
  root.choice("law", law, {"sidestep", "paper"});
  if (!overrides.law.empty()) law = overrides.law;

  config.robot = read_robot(root.section("robot"), file, overrides);
  const Robot& robot = config.robot;
  try {
    config.model.arm = load_arm(robot.urdf, robot.base, robot.tip, robot.meshes, robot.joint_positions);
  } catch (const BadJointPosition& error) {
    root.section("robot").section("joint_positions").fail(error.joint, error.what());
  }
  read_dialect(root, config);
  const JointLimits of_urdf = config.model.arm.limits;
  read_limits(root.section("limits"), config.model.arm);
  read_control(root.section("control"), overrides.rate_hz, settings);
  read_paper(root.section("paper"), settings.paper);
  root.renamed("ages", "timeouts");
  read_timeouts(root.section("timeouts"), settings.timeouts);
  read_obstacles(root.section("obstacles"), settings);
  read_channels(root.section("channels"), config.channels);
  read_neighbours(root.section("neighbours"), settings.wait_for_obstacles, config.neighbours);
  check_channels_are_unique(root, config);
  read_blackbox(root.section("blackbox"), config.blackbox);
  read_sidestep(root.section("sidestep"), settings.sidestep);
  read_shield(root.section("shield"), settings.shield);
  read_foresight(root.section("foresight"), settings.foresight);
  config.model.surroundings = read_surroundings(root);
  config.warnings = warnings_of(settings, config.model.arm, of_urdf);
  use_law(settings, law == "paper" ? Law::kPaper : Law::kSidestep);
  root.finish();
  config.model.self_pairs =  // slow, hence last
      find_self_pairs(config.model.arm, settings.shield.self_clearance_m, ignored_pairs(robot)).kept;
  return config;
}

}  // namespace sidestep
