#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>

#include "host/sim/run.h"

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

void declare(CLI::App& app, Options& options) {
  app.add_option("--scenario", options.scenario, "what to play, such as paper-c.yaml")->required()->type_name("FILE");
  app.add_flag(
      "--lockstep", options.lockstep,
      "play on the arm's clock: deterministic, as fast as both processes can go (controller: --lockstep, too)");
  app.add_option("--lcm-url", options.lcm_url, "LCM provider (default: LCM_DEFAULT_URL or LCM's own)")
      ->type_name("URL");
  app.add_option("--log", options.log_file, "keep all messages in this lcm-logger log")->type_name("FILE");
  app.add_option("--csv", options.csv_file, "one row per control period into this file")->type_name("FILE");
  app.add_option("--wait", options.patience_s, "give up when the controller does not track within this time, s")
      ->capture_default_str()
      ->check(CLI::Range(0.1, 86400.0))
      ->type_name("SECONDS");
  app.add_flag("--quiet", options.quiet, "no live line");
  app.footer(
      "Exit code: 0 the scenario's expectations held, 1 broken, 2 bad arguments or files, 3 no controller, or lost,\n"
      "130 interrupted.");
}

// Says how the run ended, and returns the exit code.
int conclude(End end, const Run& run, const Bus& bus) {
  if (run.tracked()) fmt::print("{}", run.summary().text(run.scenario()));
  if (run.plant.refused() > 0) fmt::print("  refused commands          {}\n", run.plant.refused());
  if (bus.malformed() > 0) fmt::print("  malformed messages        {}\n", bus.malformed());
  if (!bus.log_good()) fmt::print(stderr, "sim: --log: could not be written completely\n");
  switch (end) {
    case End::kInterrupted:
      return kInterruptedBySignal;
    case End::kLost:
      fmt::print(stderr, "sim: the controller is lost: no answer for 5 s\n");
      return kNoController;
    case End::kNeverTracked:
      fmt::print(stderr, "sim: gave up waiting for {}\n", run.waits_for());
      return kNoController;
    case End::kDone:
      break;
  }
  const auto broken = run.summary().broken(run.scenario().expect);
  for (const std::string& line : broken) fmt::print("  BROKEN {}\n", line);
  return broken.empty() ? kHeld : kBroken;
}

int play(const Options& options) {
  const Scenario scenario = load_scenario(options.scenario);
  Truth truth(Arm(scenario.robot.urdf_file, scenario.robot.base, scenario.robot.tip));
  if (truth.joints() != scenario.start_rad.size()) {
    throw std::runtime_error(fmt::format("{}: start_rad: has {} values, the arm has {} joints", scenario.file,
                                         scenario.start_rad.size(), truth.joints()));
  }
  Bus bus(options.lcm_url, options.log_file);
  std::optional<CsvFile> csv;
  const auto obstacles = static_cast<int>(scenario.world.obstacles.size());
  if (!options.csv_file.empty()) csv.emplace(options.csv_file, truth.joints(), obstacles);
  Live live(options.quiet, options.lockstep);
  Run run(scenario, truth, live, csv ? &*csv : nullptr);
  const auto loop = options.lockstep ? run_lockstep : run_realtime;
  const End end = loop(run, bus, options.patience_s, interrupted);
  live.end();
  const int exit_code = conclude(end, run, bus);
  if (csv) csv->close();
  return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Sidestep's simulator: plant, world and judge for a controller on the other end of LCM.");
  Options options;
  declare(app, options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kHeld : kBadInput;
  }
  std::signal(SIGINT, [](int) { interrupted = true; });
  std::signal(SIGTERM, [](int) { interrupted = true; });
  try {
    return play(options);
  } catch (const std::exception& error) {
    fmt::print(stderr, "sim: {}\n", error.what());
    return kBadInput;
  }
}
