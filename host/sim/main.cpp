#include <fmt/format.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <filesystem>

#include "firmware/base/command_line.h"
#include "host/sim/play.h"

namespace {

using namespace sidestep::sim;

enum ExitCode { kHeld = 0, kBroken = 1, kBadInput = 2, kNoController = 3, kInterruptedBySignal = 130 };

std::atomic<bool> interrupted{false};

struct Options {
  std::string scenario, lcm_url, log_file, csv_file;
  bool lockstep = false;
  bool quiet = false;
  double patience_s = 30.0;
};

void declare(sidestep::CommandLine& app, Options& options) {
  app.add_option("--scenario", options.scenario, "what to play, such as paper-c.yaml").required().type_name("FILE");
  app.add_flag(
      "--lockstep", options.lockstep,
      "play on the arm's clock: deterministic, as fast as both processes can go (controller: --lockstep, too)");
  app.add_option("--lcm-url", options.lcm_url, "LCM provider (default: LCM_DEFAULT_URL or LCM's own)").type_name("URL");
  app.add_option("--log", options.log_file, "keep all messages in this lcm-logger log").type_name("FILE");
  app.add_option("--csv", options.csv_file,
                 "one row per control period into this file; of several arms into one with the arm's name before its "
                 "suffix each")
      .type_name("FILE");
  app.add_option("--wait", options.patience_s, "give up when the controller does not track within this time, s")
      .show_default()
      .range(0.1, 86400.0)
      .not_nan()
      .type_name("SECONDS");
  app.add_flag("--quiet", options.quiet, "no live line");
  app.footer(
      "Exit code: 0 the scenario's expectations held, 1 broken, 2 bad arguments or files, 3 no controller, or lost,\n"
      "130 interrupted.");
}

// Prints the figures of one arm; returns how many expectations are broken.
size_t tell(const Run& run, bool judged) {
  if (run.tracked()) fmt::print("{}", run.summary().text(run.scenario()));
  if (run.plant.refused() > 0) fmt::print("  refused commands          {}\n", run.plant.refused());
  if (!judged) return 0;
  const auto broken = run.summary().broken(run.scenario().expect);
  for (const std::string& line : broken) fmt::print("  BROKEN {}\n", line);
  return broken.size();
}

// Says how the play ended, and returns the exit code.
int conclude(End end, const Play& play, const Bus& bus) {
  size_t broken = 0;
  for (const Run& run : play.runs) broken += tell(run, end == End::kDone);
  if (bus.malformed() > 0) fmt::print("  malformed messages        {}\n", bus.malformed());
  if (!bus.log_good()) fmt::print(stderr, "sim: --log: could not be written completely\n");
  switch (end) {
    case End::kInterrupted:
      return kInterruptedBySignal;
    case End::kLost:
      fmt::print(stderr, "sim: the controller is lost: no answer for 5 s\n");
      return kNoController;
    case End::kNeverTracked:
      fmt::print(stderr, "sim: gave up waiting for {}\n", play.waits_for());
      return kNoController;
    case End::kDone:
      break;
  }
  return broken == 0 ? kHeld : kBroken;
}

// run.csv of the arm left is run-left.csv.
std::string csv_file_of(const Scenario& scenario, const std::filesystem::path& file) {
  if (file.empty() || scenario.arm.empty()) return file;
  return file.parent_path() / (file.stem().string() + '-' + scenario.arm + file.extension().string());
}

int play(const Options& options) {
  std::vector<Run> runs;
  std::vector<Channels> channels;
  for (const Scenario& scenario : load_scenario(options.scenario)) {
    runs.emplace_back(scenario, csv_file_of(scenario, options.csv_file));
    channels.push_back(scenario.channels);
  }
  Bus bus(options.lcm_url, options.log_file, channels);
  Play play(std::move(runs), Live(options.quiet, options.lockstep));
  const auto loop = options.lockstep ? run_lockstep : run_realtime;
  const End end = loop(play, bus, options.patience_s, interrupted);
  play.end_live();
  const int exit_code = conclude(end, play, bus);
  for (Run& run : play.runs) run.close_csv();
  return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  sidestep::CommandLine app("Sidestep's simulator: plant, world and judge for a controller on the other end of LCM.");
  Options options;
  declare(app, options);
  if (const auto exit_code = app.parse(argc, argv)) return *exit_code;
  std::signal(SIGINT, [](int) { interrupted = true; });
  std::signal(SIGTERM, [](int) { interrupted = true; });
  try {
    return play(options);
  } catch (const std::exception& error) {
    fmt::print(stderr, "sim: {}\n", error.what());
    return kBadInput;
  }
}
