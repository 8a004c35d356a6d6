#include <filesystem>
#include <functional>
#include <regex>
#include <vector>

#include "tests/support/check.h"
#include "tests/support/scratch.h"

namespace {

namespace fs = std::filesystem;

/// The code of a file: without comments and without what stands between quotes on a line that is no include.
std::string code_of(const std::string& file) {
  std::string text = sidestep::test::text_of(file);
  text = std::regex_replace(text, std::regex("//[^\n]*"), "");
  return std::regex_replace(text, std::regex("\"[^\"\n]*\"(?=[^\n]*[;,)])"), "\"\"");
}

struct Rule {
  const char* what;
  const char* pattern;
  std::vector<std::string> allowed;  ///< files or folders
};

const Rule kRules[] = {
    {"LCM only in the wire and its log",
     R"(#\s*include\s*[<"]lcm)",
     {"firmware/io/lcm/wire.cpp", "firmware/io/blackbox/blackbox_log.cpp"}},
    {"the wire's layouts only where bytes become values or values bytes",
     R"(#\s*include\s*<(sidestep|drake)/)",
     {"firmware/io/lcm/encoder.cpp", "firmware/io/lcm/admission.cpp", "firmware/io/lcm/arm_reader.cpp",
      "firmware/io/lcm/obstacle_encoder.cpp", "firmware/io/blackbox/blackbox_log.cpp"}},
    {"clocks only in io/realtime",
     R"(<chrono>|<ctime>|<time\.h>|\b(clock_gettime|clock_nanosleep|gettimeofday|nanosleep|usleep|steady_clock|system_clock|sleep_for)\b)",
     {"firmware/base/realtime.cpp"}},
    {"arguments and signals only in main",
     R"(\bargv\b|<csignal>|<signal\.h>|CLI/)",
     {"firmware/main.cpp", "firmware/base/command_line.h", "firmware/base/command_line.cpp"}},
    {"files only at start-up and in the blackbox",
     R"(<fstream>|<filesystem>|<cstdio>|\bfopen\b|LogFile)",
     {"firmware/base/find_file.cpp", "firmware/base/text_file.cpp", "firmware/io/blackbox/blackbox.cpp",
      "firmware/io/blackbox/blackbox_log.cpp", "firmware/model/load/mesh.cpp", "firmware/model/load/fit_cache.cpp"}},
    {"no throw in the cycle",
     R"(\bthrow\b|<stdexcept>)",
     {"firmware/io", "firmware/library", "firmware/base/fail.h", "firmware/model/load/mesh.cpp", "firmware/main.cpp"}},
    {"no heap in the cycle",
     R"(\bnew\b|\bmalloc\b|make_unique|make_shared|push_back|emplace_back|std::string\s*\()",
     {"firmware/io", "firmware/library", "firmware/model/load", "firmware/foresight/foresight_thread.cpp",
      "firmware/base/bounded_list.h" /* in place */, "firmware/base/command_line.cpp", "firmware/main.cpp"}},
    {"no threads in the cycle",
     R"(<thread>|<mutex>|<atomic>|<condition_variable>|<future>)",
     {"firmware/io", "firmware/foresight/foresight_thread.h", "firmware/base/triple_buffer.h", "firmware/main.cpp"}},
    {"no chance in the cycle",
     R"(<random>|\brand\s*\(|random_device)",
     {"firmware/model/load/self_pairs.cpp", "firmware/model/load/circle.cpp"}},
    {"the firmware knows neither host nor tests", R"(#\s*include\s*"(host|tests)/)", {}},
    {"no printing in the cycle",
     R"(<iostream>|spdlog|\bprintf\b|std::cout|std::cerr)",
     {"firmware/io", "firmware/main.cpp"}},
    {"the cycle knows no shell",
     R"(#\s*include\s*"firmware/io/)",
     {"firmware/io", "firmware/library", "firmware/main.cpp"}},
    {"the model knows no control",
     R"(#\s*include\s*"firmware/(control|io|foresight)/)",
     {"firmware/io", "firmware/control", "firmware/foresight", "firmware/library", "firmware/main.cpp"}},
    {"the cycle takes guides, it does not look ahead",
     R"(#\s*include\s*"firmware/foresight/)",
     {"firmware/io", "firmware/foresight", "firmware/library", "firmware/main.cpp"}},
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

void every_part_of_the_firmware_keeps_to_its_layer(void**) {
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

/// Each rule must be able to fail: what it forbids is found where it is allowed.
void the_rules_can_see(void**) {
  const struct {
    const char* file;
    size_t rule;
  } known[] = {{"firmware/io/lcm/wire.cpp", 0},
               {"firmware/io/lcm/admission.cpp", 1},
               {"firmware/base/realtime.cpp", 2},
               {"firmware/main.cpp", 3},
               {"firmware/base/find_file.cpp", 4},
               {"firmware/base/fail.h", 5},
               {"firmware/model/load/load_arm.cpp", 6},
               {"firmware/io/loop/loop_realtime.cpp", 7},
               {"firmware/model/load/self_pairs.cpp", 8},
               {"firmware/main.cpp", 10},
               {"firmware/main.cpp", 11},
               {"firmware/control/cycle.h", 12},
               {"tests/unit/project/layers.cpp", 9}};
  for (const auto& one : known)
    check(std::regex_search(code_of(one.file), std::regex(kRules[one.rule].pattern)), "'%s' is blind",
          kRules[one.rule].what);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(every_part_of_the_firmware_keeps_to_its_layer),
      cmocka_unit_test(the_rules_can_see),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
