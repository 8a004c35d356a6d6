#pragma once

#include <string>

#include "firmware/io/config/yaml_section.h"
#include "firmware/io/lcm/channels.h"

namespace sidestep {

/// Throws when the name is longer than LCM can send.
void check_channel_length(const YamlSection& section, const std::string& key, const std::string& name);

/// The name of one channel; unchanged when the key is absent.
void read_channel(YamlSection& section, const std::string& key, std::string& name);

/// The section `channels`.
void read_channels(YamlSection section, Channels& channels);

}  // namespace sidestep
