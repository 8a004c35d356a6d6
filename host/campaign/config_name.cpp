#include "host/campaign/config_name.h"

#include <fmt/format.h>

#include <filesystem>
#include <stdexcept>

#include "firmware/base/find_file.h"

namespace sidestep::campaign {

std::string config_name(const std::string& in_source_tree) {
  const std::string installed = "config/" + std::filesystem::path(in_source_tree).filename().string();
  for (const std::string& name : {in_source_tree, installed})
    if (!find_file(name).empty()) return name;
  throw std::runtime_error(
      fmt::format("{}: not found in this folder, in those above it, or installed", in_source_tree));
}

}  // namespace sidestep::campaign
