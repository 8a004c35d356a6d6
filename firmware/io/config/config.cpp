#include "firmware/io/config/config.h"

#include <fmt/format.h>

#include <limits>
#include <map>

#include "firmware/base/find_file.h"
#include "firmware/io/config/channel_section.h"
#include "firmware/io/config/surroundings.h"
#include "firmware/io/config/yaml_section.h"
#include "firmware/model/load/self_pairs.h"

namespace sidestep {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr NumberRange kAnyNumber{-kInfinity, kInfinity};  // check_limits() decides

void read_limits(YamlSection limits, Arm& arm) {
  limits.per_joint("velocity_radps", arm.joints, arm.limits.velocity_radps, kAnyNumber);
  limits.per_joint("acceleration_radps2", arm.joints, arm.limits.acceleration_radps2, kAnyNumber);
  limits.per_joint("lower_rad", arm.joints, arm.limits.lower_rad, kAnyNumber);
  limits.per_joint("upper_rad", arm.joints, arm.limits.upper_rad, kAnyNumber);
  limits.finish();
  try {
    check_limits(arm);
  } catch (const std::exception& error) {
    limits.fail("velocity_radps, acceleration_radps2, lower_rad or upper_rad", error.what());
  }
}

void read_paper(YamlSection paper, PaperGains& gains) {
  paper.not_negative("k_pos_per_s2", gains.k_pos_per_s2);
  paper.not_negative("k_vel_per_s", gains.k_vel_per_s);
  paper.not_negative("k_rpos_m2ps2", gains.k_rpos_m2ps2);
  paper.not_negative("k_rvel_m2ps2", gains.k_rvel_m2ps2);
  paper.positive("rho_0_m", gains.rho_0_m);
  paper.positive("rho_v_m", gains.rho_v_m);
  paper.positive("rho_min_m", gains.rho_min_m);
  paper.positive("v_max_mps", gains.v_max_mps);
  paper.not_negative("lambda_0", gains.lambda_0);
  paper.positive("sigma_0", gains.sigma_0);
  paper.positive("lambda_n", gains.lambda_n);
  paper.not_negative("x_m_mps", gains.x_m_mps);
  paper.positive("d_m_m", gains.d_m_m);
  paper.positive("d_1_m", gains.d_1_m);
  paper.not_negative("d_2_m", gains.d_2_m);
  paper.not_negative("k_ori_per_s", gains.k_ori_per_s);
  std::string tool_velocity = "measured";
  paper.choice("tool_velocity", tool_velocity, {"measured", "planned"});
  gains.tool_velocity = tool_velocity == "planned" ? ToolVelocity::kPlanned : ToolVelocity::kMeasured;
  if (gains.d_2_m >= gains.d_1_m) paper.fail("d_2_m", "must be below d_1_m");
  paper.finish();
}

void read_sidestep(YamlSection sidestep, SidestepGains& gains) {
  sidestep.positive("k_pos_per_s", gains.k_pos_per_s);
  sidestep.positive("k_ori_per_s", gains.k_ori_per_s);
  sidestep.not_negative("k_posture_per_s", gains.k_posture_per_s);
  sidestep.positive("k_guide_per_s", gains.k_guide_per_s);
  sidestep.not_negative("guide_posture_share", gains.guide_posture_share);
  sidestep.positive("v_max_mps", gains.v_max_mps);
  sidestep.not_negative("lambda_0", gains.lambda_0);
  sidestep.positive("sigma_0", gains.sigma_0);
  sidestep.finish();
}

void read_shield(YamlSection section, ShieldSettings& shield) {
  section.flag("enabled", shield.enabled);
  section.not_negative("hard_clearance_m", shield.hard_clearance_m);
  section.positive("hard_gain_per_s", shield.hard_gain_per_s);
  section.not_negative("pass_clearance_m", shield.pass_clearance_m);
  section.positive("pass_gain_per_s", shield.pass_gain_per_s);
  section.not_negative("pass_reaction_s", shield.pass_reaction_s);
  section.number("pass_horizon_s", shield.pass_horizon_s, {0.0, 10.0});
  section.not_negative("comfort_clearance_m", shield.comfort_clearance_m);
  section.positive("comfort_gain_per_s", shield.comfort_gain_per_s);
  section.positive("comfort_weight", shield.comfort_weight);
  section.positive("comfort_least_weight", shield.comfort_least_weight);
  section.not_negative("comfort_near_m", shield.comfort_near_m);
  section.positive("comfort_far_m", shield.comfort_far_m);
  if (shield.comfort_far_m <= shield.comfort_near_m) section.fail("comfort_far_m", "must be above comfort_near_m");
  section.not_negative("tool_weight", shield.tool_weight);
  section.not_negative("self_clearance_m", shield.self_clearance_m);
  section.positive("range_m", shield.range_m);
  if (shield.pass_clearance_m <= shield.hard_clearance_m)
    section.fail("pass_clearance_m", "must be above hard_clearance_m");
  section.finish();
}

void read_timeouts(YamlSection section, Timeouts& timeouts) {
  section.renamed("old_place_s", "coast_s");
  section.positive("target_s", timeouts.target_s);
  section.positive("obstacles_s", timeouts.obstacles_s);
  section.positive("arm_state_s", timeouts.arm_state_s);
  section.positive("arm_state_lost_s", timeouts.arm_state_lost_s);
  section.not_negative("consistent_s", timeouts.consistent_s);
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
  control.positive("following_error_rad", settings.following_error_rad);
  control.finish();
}

void read_obstacles(YamlSection obstacles, Settings& settings) {
  obstacles.flag("wait_for_first", settings.wait_for_obstacles);
  obstacles.not_negative("speed_bound_mps", settings.obstacle_speed_bound_mps);
  obstacles.number("latency_s", settings.obstacle_trust.latency_s, {0.0, 1.0});
  obstacles.not_negative("uncertainty_m", settings.obstacle_trust.uncertainty_m);
  obstacles.not_negative("acceleration_bound_mps2", settings.obstacle_trust.acceleration_bound_mps2);
  obstacles.finish();
}

/// Messages of two kinds on one channel could not be told apart, so every channel name must be unique.
void check_channels_are_unique(const YamlSection& root, const Config& config) {
  const Channels& channels = config.channels;
  const Neighbours& neighbours = config.neighbours;
  std::vector<std::pair<std::string, std::string>> names = {{"channels.target", channels.target},
                                                            {"channels.obstacles", channels.obstacles},
                                                            {"channels.arm_state", channels.arm_state},
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
  section.not_negative("clearance_m", foresight.clearance_m);
  section.whole("seed", foresight.seed, {0.0, 1e9});
  section.finish();
}

void read_dialect(YamlSection& root, Config& config) {
  std::string dialect = "sidestep";
  root.choice("dialect", dialect, {"sidestep", "iiwa"});
  if (dialect != "iiwa") return;
  if (config.model.arm.joints != kIiwaJoints)
    root.fail("dialect", fmt::format("iiwa is for {} joints, the arm has {}", kIiwaJoints, config.model.arm.joints));
  config.dialect = Dialect::kIiwa;
  config.model.settings.start_guard_s = kIiwaStartGuard_s;
  config.channels.arm_state = "IIWA_STATUS";
  config.channels.arm_command = "IIWA_COMMAND";
}

Robot read_robot(YamlSection section, const std::string& config_file, const Overrides& overrides) {
  Robot robot;
  section.text("urdf", robot.urdf);
  section.text("base", robot.base);
  section.text("tip", robot.tip);
  section.texts("package_path", robot.meshes.package_path);
  section.whole("capsules_per_mesh", robot.meshes.capsules_per_mesh, {1.0, 8.0});
  section.finish();
  if (!overrides.urdf.empty()) robot.urdf = overrides.urdf;
  if (!overrides.base.empty()) robot.base = overrides.base;
  if (!overrides.tip.empty()) robot.tip = overrides.tip;
  if (robot.urdf.empty()) section.fail("urdf", "is missing (or give --urdf)");
  if (robot.base.empty()) section.fail("base", "is missing (or give --base)");
  if (robot.tip.empty()) section.fail("tip", "is missing (or give --tip)");
  if (overrides.urdf.empty())
    if (const std::string found = find_file(robot.urdf, config_file); !found.empty()) robot.urdf = found;
  return robot;
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
  settings.law = law == "paper" ? Law::kPaper : Law::kSidestep;

  config.robot = read_robot(root.section("robot"), file, overrides);
  const Robot& robot = config.robot;
  config.model.arm = load_arm(robot.urdf, robot.base, robot.tip, robot.meshes);
  read_dialect(root, config);
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
  root.finish();
  config.model.self_pairs = find_self_pairs(config.model.arm, settings.shield.self_clearance_m);  // slow, hence last
  return config;
}

}  // namespace sidestep
