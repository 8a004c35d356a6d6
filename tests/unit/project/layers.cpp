#include <algorithm>
#include <filesystem>
#include <functional>
#include <map>
#include <regex>
#include <set>
#include <vector>

#include "tests/support/check.h"
#include "tests/support/scratch.h"

namespace {

namespace fs = std::filesystem;

/// The code of a file: without comments, and without quoted text except on include lines.
std::string code_of(const std::string& file) {
  std::string text = sidestep::test::text_of(file);
  text = std::regex_replace(text, std::regex("//[^\n]*"), "");
  return std::regex_replace(text, std::regex("\"[^\"\n]*\"(?=[^\n]*[;,)])"), "\"\"");
}

/// A pattern that only the allowed files or folders may contain. `example` is one that contains it, which proves that
/// the rule can fail.
struct Rule {
  const char* what;
  const char* pattern;
  const char* example;
  std::vector<std::string> allowed;
};

const Rule kRules[] = {
    {"LCM only in the wire and its log",
     R"(#\s*include\s*[<"]lcm)",
     "firmware/io/lcm/wire.cpp",
     {"firmware/io/lcm/wire.cpp", "firmware/io/blackbox/blackbox_log.cpp"}},
    {"generated message types only where bytes are decoded or encoded",
     R"(#\s*include\s*<(sidestep|drake)/)",
     "firmware/io/lcm/message_decoder.cpp",
     {"firmware/io/lcm/message_decoder.cpp", "firmware/io/lcm/encoder.cpp", "firmware/io/lcm/obstacle_encoder.cpp",
      "firmware/io/lcm/dialect_sidestep.cpp", "firmware/io/lcm/dialect_iiwa.cpp",
      "firmware/io/blackbox/blackbox_log.cpp"}},
    {"clocks only in base/realtime",
     R"(<chrono>|<ctime>|<time\.h>|\b(clock_gettime|clock_nanosleep|gettimeofday|nanosleep|usleep|steady_clock|system_clock|sleep_for)\b)",
     "firmware/base/realtime.cpp",
     {"firmware/base/realtime.cpp"}},
    {"sockets only in the receiver and the watchdog",
     R"(<sys/socket\.h>|<netinet/|<poll\.h>)",
     "firmware/io/lcm/udp_receiver.cpp",
     {"firmware/io/lcm/udp_receiver.cpp", "firmware/io/loop/service_watchdog.cpp"}},
    {"readings of the clock only outside the cycle",
     R"(base/realtime\.h)",
     "firmware/io/loop/loop_realtime.cpp",
     {"firmware/base/realtime.cpp", "firmware/foresight/foresight_thread.cpp", "firmware/io"}},
    {"arguments only in main and base/command_line, signals only in main",
     R"(\bargv\b|<csignal>|<signal\.h>|CLI/)",
     "firmware/main.cpp",
     {"firmware/main.cpp", "firmware/base/command_line.h", "firmware/base/command_line.cpp"}},
    {"files only at start-up and in the blackbox",
     R"(<fstream>|<filesystem>|<cstdio>|\bfopen\b|LogFile)",
     "firmware/base/find_file.cpp",
     {"firmware/base/find_file.cpp", "firmware/base/text_file.cpp", "firmware/io/blackbox", "firmware/model/load"}},
    {"no exception in the cycle, also not by a function that throws",
     R"(\bthrow\b|<stdexcept>|\bfail\s*\(|base/fail\.h)",
     "firmware/model/load/mesh.cpp",
     {"firmware/io", "firmware/library", "firmware/model/load", "firmware/base/fail.h", "firmware/base/text_file.cpp",
      "firmware/main.cpp"}},
    {"no heap in the cycle",
     R"(\bnew\b|\bmalloc\b|make_unique|make_shared|push_back|emplace_back|std::string\s*\()",
     "firmware/model/load/load_arm.cpp",
     {"firmware/io", "firmware/library", "firmware/model/load", "firmware/foresight/foresight_thread.cpp",
      "firmware/base/bounded_list.h" /* in place */, "firmware/base/command_line.cpp", "firmware/main.cpp"}},
    {"no threads in the cycle",
     R"(<thread>|<mutex>|<atomic>|<condition_variable>|<future>)",
     "firmware/io/loop/loop_realtime.cpp",
     {"firmware/io", "firmware/foresight/foresight_thread.h", "firmware/base/triple_buffer.h", "firmware/main.cpp"}},
    {"no random numbers in the cycle",
     R"(<random>|\brand\s*\(|random_device|split_mix64)",
     "firmware/model/load/self_pairs.cpp",
     {"firmware/model/load", "firmware/base/split_mix64.h", "firmware/base/split_mix64.cpp", "firmware/foresight"}},
    {"the firmware includes neither host nor tests", R"(#\s*include\s*"(host|tests)/)", "host/sim/main.cpp", {}},
    {"no printing in the cycle",
     R"(<iostream>|spdlog|\bprintf\b|std::cout|std::cerr)",
     "firmware/main.cpp",
     {"firmware/base/command_line.cpp", "firmware/base/log.cpp", "firmware/main.cpp"}},
    {"which law runs is decided in settings.cpp, evaluated in the cycle, and chosen by configuration and main",
     R"(Law::k)",
     "firmware/control/cycle.cpp",
     {"firmware/control/types/settings.h", "firmware/control/types/settings.cpp", "firmware/control/cycle.cpp",
      "firmware/io/config/config.cpp", "firmware/main.cpp"}},
};

/// The folders of the firmware and the folders that each may include besides itself. Every entry names only folders
/// above it in this list, so that there is no cycle.
const std::vector<std::pair<std::string, std::vector<std::string>>> kLayers = {
    {"base", {}},
    {"model", {"base"}},
    {"model/load", {"base", "model"}},
    {"control/types", {"base", "model"}},
    {"control/paper", {"base", "model", "control/types"}},
    {"control/shield", {"base", "model", "control/types"}},
    {"control", {"base", "model", "control/types", "control/paper", "control/shield"}},
    {"foresight", {"base", "model", "control/types", "control/shield", "control"}},
    {"io/lcm", {"base", "model", "control/types", "control"}},
    {"io/config", {"base", "model", "model/load", "control/types", "control", "io/lcm"}},
    {"io/blackbox", {"base", "model", "control/types", "control", "io/lcm", "io/config"}},
    {"io/loop", {"base", "model", "control/types", "control", "foresight", "io/lcm", "io/config", "io/blackbox"}},
    {"library", {"base", "model", "control/types", "control", "foresight", "io/lcm", "io/config"}},
};

bool allows(const Rule& rule, const std::string& file) {
  for (const std::string& place : rule.allowed)
    if (file == place || file.rfind(place + "/", 0) == 0) return true;
  return false;
}

std::vector<std::string> firmware_files() {
  std::vector<std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator("firmware"))
    if (entry.path().extension() == ".cpp" || entry.path().extension() == ".h") files.push_back(entry.path().string());
  return files;
}

/// The folder of a file of the firmware, from firmware/ on; empty for main.cpp.
std::string folder_of(const std::string& file) {
  const fs::path folder = fs::path(file).parent_path().lexically_relative("firmware");
  return folder == "." ? "" : folder.string();
}

std::set<std::string> included_folders(const std::string& file) {
  std::set<std::string> folders;
  const std::string code = code_of(file);
  const std::regex include(R"re(#\s*include\s*"(firmware/[^"]*)")re");
  for (std::sregex_iterator found(code.begin(), code.end(), include), end; found != end; ++found)
    folders.insert(folder_of((*found)[1]));
  return folders;
}

void every_file_of_the_firmware_keeps_the_rules_of_its_folder(void**) {
  const std::vector<std::string> files = firmware_files();
  check(files.size() > 30, "only %zu files found", files.size());
  int wrong = 0;
  for (const std::string& file : files) {
    const std::string code = code_of(file);
    for (const Rule& rule : kRules) {
      std::smatch found;
      if (allows(rule, file) || !std::regex_search(code, found, std::regex(rule.pattern))) continue;
      print_error("%s: '%s' (%s)\n", file.c_str(), found.str().c_str(), rule.what);
      ++wrong;
    }
  }
  assert_int_equal(wrong, 0);
}

void every_rule_finds_its_example(void**) {
  for (const Rule& rule : kRules)
    check(std::regex_search(code_of(rule.example), std::regex(rule.pattern)), "'%s' does not find %s", rule.what,
          rule.example);
}

void folders_include_only_the_folders_below_them(void**) {
  std::map<std::string, std::vector<std::string>> allowed;
  for (const auto& [folder, below] : kLayers) {
    for (const std::string& each : below)
      check(allowed.count(each) == 1, "%s: %s is not above it in the list", folder.c_str(), each.c_str());
    allowed[folder] = below;
  }
  int wrong = 0;
  for (const std::string& file : firmware_files()) {
    const std::string folder = folder_of(file);
    if (folder.empty()) continue;  // main.cpp
    check(allowed.count(folder) == 1, "%s: add the folder to kLayers", file.c_str());
    for (const std::string& included : included_folders(file)) {
      const auto& below = allowed[folder];
      if (included == folder || std::find(below.begin(), below.end(), included) != below.end()) continue;
      print_error("%s includes %s\n", file.c_str(), included.c_str());
      ++wrong;
    }
  }
  assert_int_equal(wrong, 0);
}

/// The check above can fail: the includes that it looks at are found.
void the_includes_of_a_file_are_found(void**) {
  const std::set<std::string> folders = included_folders("firmware/control/cycle.cpp");
  for (const char* folder : {"control", "control/paper", "control/shield"})
    check(folders.count(folder) == 1, "%s is not found", folder);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(every_file_of_the_firmware_keeps_the_rules_of_its_folder),
      cmocka_unit_test(every_rule_finds_its_example),
      cmocka_unit_test(folders_include_only_the_folders_below_them),
      cmocka_unit_test(the_includes_of_a_file_are_found),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
