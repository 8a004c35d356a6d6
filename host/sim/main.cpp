#include <fmt/format.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <filesystem>

#include "firmware/base/command_line.h"
#include "firmware/base/realtime.h"
#include "firmware/io/lcm/lcm_url.h"
#include "host/sim/simulation.h"

namespace {

using namespace sidestep::sim;

// In real time the simulator stands for an arm, which does not wait for a CPU. Below the threads of the controller.
constexpr int kPriority = 60;

enum ExitCode { kHeld = 0, kBroken = 1, kBadInput = 2, kNoController = 3, kInterruptedBySignal = 130 };

std::atomic<bool> interrupted{false};

struct Options {
  std::string scenario, lcm_url, log_file, csv_file;
  bool list_obstacles = false;
  bool lockstep = false;
  bool quiet = false;
  double patience_s = 30.0;
};

void declare(sidestep::CommandLine& app, Options& options) {
  app.add_option("--scenario", options.scenario, "scenario file, such as paper-c.yaml").required().type_name("FILE");
  app.add_flag("--list-obstacles", options.list_obstacles,
               "print ids, shapes and kinds of the scenario's obstacles and of the parts of its people, and exit");
  app.add_flag("--lockstep", options.lockstep,
               "run on the arm's clock: deterministic, as fast as possible (the controller also needs --lockstep)");
  app.add_option("--lcm-url", options.lcm_url, "LCM network (default: LCM_DEFAULT_URL or LCM's own)").type_name("URL");
  app.add_option("--log", options.log_file, "write all messages to this log, in lcm-logger's format").type_name("FILE");
  app.add_option("--csv", options.csv_file,
                 "write one row per control period to this file; with several arms one file each, with the arm's name "
                 "before the suffix")
      .type_name("FILE");
  app.add_option("--wait", options.patience_s, "exit when the controller does not track within this time, s")
      .show_default()
      .range(0.1, 86400.0)
      .not_nan()
      .type_name("SECONDS");
  app.add_flag("--quiet", options.quiet, "no progress line");
  app.footer(
      "Exit code: 0 all expectations held, 1 one was broken, 2 bad arguments or files, 3 controller missing or lost,\n"
      "130 interrupted.");
}

// Prints the figures of one arm; returns the number of broken expectations. These are checked only for a complete run.
size_t print_results(const Run& run, bool complete) {
  if (run.tracked()) fmt::print("{}", run.summary().text(run.scenario()));
  if (run.plant.refused() > 0) fmt::print("  refused commands          {}\n", run.plant.refused());
  if (!complete) return 0;
  const auto broken = run.summary().broken(run.scenario().expect);
  for (const std::string& line : broken) fmt::print("  BROKEN {}\n", line);
  return broken.size();
}

// Prints the outcome and returns the exit code.
int conclude(Outcome outcome, const Simulation& simulation, const SimWire& wire) {
  size_t broken = 0;
  for (const Run& run : simulation.runs) broken += print_results(run, outcome == Outcome::kDone);
  if (wire.malformed() > 0) fmt::print("  malformed messages        {}\n", wire.malformed());
  if (!wire.log_good()) fmt::print(stderr, "sim: --log: could not be written completely\n");
  switch (outcome) {
    case Outcome::kInterrupted:
      return kInterruptedBySignal;
    case Outcome::kLost:
      fmt::print(stderr, "sim: the controller is lost: no message for 5 s\n");
      return kNoController;
    case Outcome::kNeverTracked:
      fmt::print(stderr, "sim: timed out waiting for {}\n", simulation.waits_for());
      return kNoController;
    case Outcome::kDone:
      break;
  }
  return broken == 0 ? kHeld : kBroken;
}

// With several arms: run.csv becomes run-left.csv for the arm `left`.
std::string csv_file_of(const Scenario& scenario, const std::filesystem::path& file) {
  if (file.empty() || scenario.arm.empty()) return file;
  return file.parent_path() / (file.stem().string() + '-' + scenario.arm + file.extension().string());
}

/// In the form of a scenario's list `obstacles`, without the motion.
int list_obstacles(const std::string& file) {
  const std::vector<Scenario> arms = load_scenario(file);
  for (const Obstacle& obstacle : arms.front().world.obstacles)
    fmt::print("- {{id: {}, {}, kind: {}}}\n", obstacle.id, to_yaml(obstacle.solid),
               obstacle.is_person ? "person" : "thing");
  return kHeld;
}

int simulate(const Options& options) {
  sidestep::check_lcm_url(options.lcm_url);
  std::vector<Run> runs;
  std::vector<sidestep::Channels> channels;
  for (const Scenario& scenario : load_scenario(options.scenario)) {
    runs.emplace_back(scenario, csv_file_of(scenario, options.csv_file));
    channels.push_back(scenario.channels);
  }
  std::string why_not;
  if (!options.lockstep) sidestep::use_fifo(kPriority, why_not);  // inherited by the threads of LCM
  SimWire wire(options.lcm_url, options.log_file, channels);
  for (size_t arm = 0; arm < runs.size(); ++arm) wire.leave_to_others(arm, runs[arm].scenario().world);
  Simulation simulation(std::move(runs), ProgressLine(options.quiet, options.lockstep));
  const auto loop = options.lockstep ? run_lockstep : run_realtime;
  const Outcome outcome = loop(simulation, wire, options.patience_s, interrupted);
  simulation.end_progress();
  const int exit_code = conclude(outcome, simulation, wire);
  for (Run& run : simulation.runs) run.close_csv();
  return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  sidestep::CommandLine app(
      "Sidestep's simulator: plant, world and independent measurement for a controller connected by LCM.");
  Options options;
  declare(app, options);
  if (const auto exit_code = app.parse(argc, argv)) return *exit_code;
  std::signal(SIGINT, [](int) { interrupted = true; });
  std::signal(SIGTERM, [](int) { interrupted = true; });
  try {
    return options.list_obstacles ? list_obstacles(options.scenario) : simulate(options);
  } catch (const std::exception& error) {
    fmt::print(stderr, "sim: {}\n", error.what());
    return kBadInput;
  }
}
