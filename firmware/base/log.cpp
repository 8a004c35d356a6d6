#include "firmware/base/log.h"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

namespace sidestep {
namespace {

spdlog::logger& logger() {
  static const auto only_one = [] {
    auto made = spdlog::stderr_color_mt("controller");
    made->set_pattern("%n: %v");
    return made;
  }();
  return *only_one;
}

}  // namespace

void log_info(const std::string& line) {
  logger().info(line);
}

void log_warning(const std::string& line) {
  logger().warn(line);
}

}  // namespace sidestep
