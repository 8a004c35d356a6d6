#include "tests/support/replay.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <sstream>

#include "tests/support/check.h"
#include "tests/support/process.h"

namespace sidestep::test {
namespace {

/// The replay program, or the command in $REPLAY. Under emulation $REPLAY starts the program of the emulated machine,
/// which rounds differently from the host's.
std::vector<std::string> program() {
  const char* command = std::getenv("REPLAY");
  std::istringstream words(command ? command : "build/replay");
  return {std::istream_iterator<std::string>(words), {}};
}

}  // namespace

Replay replay(const std::string& log, const std::vector<std::string>& more) {
  std::vector<std::string> arguments = program();
  arguments.push_back(log);
  arguments.insert(arguments.end(), more.begin(), more.end());
  Process process(arguments);
  const int code = process.wait(60.0);
  return {code, process.output()};
}

int agreeing_cycles(const std::string& log) {
  const Replay result = replay(log);
  check(result.code == 0 && result.output.find("all agree bit for bit") != std::string::npos, "code %d: %s",
        result.code, result.output.c_str());
  print_message("%s", result.output.c_str());
  return std::atoi(result.output.c_str());
}

std::vector<std::string> logs_in(const std::string& folder, const std::string& reason) {
  std::vector<std::string> files;
  if (std::filesystem::exists(folder))
    for (const auto& entry : std::filesystem::directory_iterator(folder))
      if (entry.path().extension() == ".lcmlog" && entry.path().stem().string().find("-" + reason) != std::string::npos)
        files.push_back(entry.path().string());
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace sidestep::test
