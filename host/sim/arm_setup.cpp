#include "host/sim/arm_setup.h"

#include "firmware/io/config/channel_section.h"
#include "firmware/io/config/yaml_geometry.h"
#include "host/sim/world_section.h"

namespace sidestep::sim {

ArmSetup load_arm_setup(const std::string& config_file) {
  YamlSection config = YamlSection::of_file(config_file);
  YamlSection neighbours = config.section("neighbours"), robot = config.section("robot");
  ArmSetup setup;
  read_channels(config.section("channels"), setup.channels);
  setup.world_from_base = read_world_from_base(neighbours);
  robot.texts("package_path", setup.package_path);
  setup.joint_positions = robot.named_numbers("joint_positions", {-1e3, 1e3});
  setup.surroundings = read_surroundings(config);
  return setup;
}

}  // namespace sidestep::sim
