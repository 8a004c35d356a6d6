#include "firmware/io/config/channel_section.h"

namespace sidestep {

void check_channel_length(const YamlSection& section, const std::string& key, const std::string& name) {
  const size_t longest = 63;  // LCM_MAX_CHANNEL_NAME_LENGTH
  if (name.size() > longest) section.fail(key, "is longer than the 63 characters that LCM can send");
}

void read_channel(YamlSection& section, const std::string& key, std::string& name) {
  section.text(key, name);
  check_channel_length(section, key, name);
}

void read_channels(YamlSection section, Channels& channels) {
  read_channel(section, "target", channels.target);
  read_channel(section, "joint_target", channels.joint_target);
  read_channel(section, "obstacles", channels.obstacles);
  read_channel(section, "arm_state", channels.arm_state);
  read_channel(section, "other_joints", channels.other_joints);
  read_channel(section, "control", channels.control);
  read_channel(section, "attachments", channels.attachments);
  read_channel(section, "arm_command", channels.arm_command);
  read_channel(section, "controller_status", channels.controller_status);
  read_channel(section, "loop_timing", channels.loop_timing);
  section.finish();
}

}  // namespace sidestep
