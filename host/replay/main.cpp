#include <fmt/format.h>

#include <cstdio>

#include "firmware/base/command_line.h"
#include "host/replay/replay.h"

namespace {

enum ExitCode { kAgrees = 0, kDiffers = 1, kBadInput = 2 };

int replay(const std::string& file, const std::string& config_file) {
  using namespace sidestep;
  BlackboxLog log(file);
  const Config config = load_config(config_file.empty() ? log.config_file() : config_file, log.overrides());
  const Comparison found = log.replay(config);
  fmt::print("{} cycles before a {}, {} commands: ", found.cycles, log.reason(), found.commands);
  if (found.different == 0) {
    fmt::print("all agree bit for bit\n");
    return kAgrees;
  }
  fmt::print("{} differ, the first in cycle {}\n", found.different, found.first_different_seq);
  return kDiffers;
}

int run(int argc, char** argv) {
  sidestep::CommandLine app(
      "Runs the control cycles of a blackbox log again and compares the commands bit for bit. Needs the build and the "
      "configuration that wrote the log.");
  std::string file, config_file;
  app.add_option("LOG", file, "a log that the controller has written").required();
  app.add_option("--config", config_file, "configuration of the controller (default: the file named in the log)");
  app.footer("Exit code: 0 all commands agree, 1 some differ, 2 bad arguments or files.");
  if (const auto exit_code = app.parse(argc, argv)) return *exit_code;
  return replay(file, config_file);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "replay: %s\n", error.what());
    return kBadInput;
  }
}
