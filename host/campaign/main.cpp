#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <thread>

#include "firmware/base/command_line.h"
#include "firmware/base/find_file.h"
#include "firmware/io/config/config.h"
#include "host/campaign/config_name.h"
#include "host/campaign/problems/problem_mover.h"
#include "host/campaign/problems/problem_table.h"
#include "host/campaign/resume.h"
#include "host/campaign/scene_export.h"
#include "host/campaign/search/finding_file.h"
#include "host/campaign/search/search_report.h"
#include "host/campaign/table.h"

namespace {

using namespace sidestep;
using namespace sidestep::campaign;

enum ExitCode { kDone = 0, kBadInput = 2, kInterruptedBySignal = 130 };

std::atomic<bool> interrupted{false};
std::atomic<double> interrupted_s{0.0};

/// The first signal lets the trials in progress end, a later one ends the program at once.
void interrupt(int signal) {
  constexpr double kSame_s = 0.3;  // `timeout` sends its signal twice, to the program and to its group
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  const double now_s = static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
  if (!interrupted.exchange(true)) {
    interrupted_s = now_s;
  } else if (now_s - interrupted_s > kSame_s) {
    std::signal(signal, SIG_DFL);
    std::raise(signal);
  }
}

struct Options {
  std::string family = "all", law = "sidestep", config, urdf, base, tip, shard = "1/1", csv, exported_scene, output,
              search, scene, problems;
  uint64_t count = 500, seed = 1;
  int obstacles = 3, decoys = 0;
  double fastest_mps = 0.5, ahead_s = 0.0;
  int jobs = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  bool quiet = false, smoothness = false, no_cpu = false, resume = false, no_velocities = false, mover = false;
  std::vector<std::string> merge;
};

void declare(CommandLine& app, Options& options) {
  app.add_option("--family", options.family,
                 "moving, fast, crowd, clutter, chase, erratic, real, follow6d, chase6d, dodge, people, furniture, "
                 "one of the variants of the last three (such as shelf or shelf@mover), boxes (five that move; the "
                 "goal is the tool's position), boxes@posture (the goal is a posture), or all, which is all but "
                 "furniture and boxes")
      .show_default();
  app.add_option("--count", options.count, "scenes of each family, runs of a search")
      .show_default()
      .range(1, static_cast<int>(kMostScenes));
  app.add_option("--seed", options.seed, "seed of the run, from which the scenes' seeds follow")
      .show_default()
      .range(0, 1'000'000'000);
  app.add_option("--law", options.law, "sidestep, paper, or plain (attraction only)")
      .show_default()
      .one_of({"sidestep", "paper", "plain"});
  app.add_option("--config", options.config, "configuration of the controller and its arm (default: the LWA3's)")
      .type_name("FILE");
  app.add_option("--urdf", options.urdf,
                 "URDF of the arm instead of the configuration's; without --config the other settings are default")
      .type_name("FILE");
  app.add_option("--base", options.base, "first link of the arm").type_name("LINK");
  app.add_option("--tip", options.tip, "last link of the arm").type_name("LINK");
  app.add_flag("--no-velocities", options.no_velocities, "report obstacles to the controller without their velocities");
  app.add_option("--ahead", options.ahead_s,
                 "report obstacles to the controller as they will be so much later, s, to see what late sensing costs")
      .show_default()
      .range(0.0, 1.0)
      .not_nan();
  app.add_option("--decoys", options.decoys,
                 "dodges: also report so many spheres at rest near the arm, all obstacles in an order that changes in "
                 "every message")
      .show_default()
      .range(0, 1000);
  app.add_option("--shard", options.shard, "run only every N-th scene (or chain of a search), starting at the I-th")
      .show_default()
      .type_name("I/N");
  app.add_option("--csv", options.csv, "write one row per trial (or finding) to this file").type_name("FILE");
  app.add_flag(
      "--resume", options.resume,
      "do not run the trials that an interrupted run with the same arguments has written to the file of --csv");
  app.add_option("--jobs", options.jobs, "number of threads").show_default().range(1, 256);
  app.add_flag("--quiet", options.quiet, "print no progress");
  app.add_flag("--smoothness", options.smoothness, "also print how smooth the commands were");
  app.add_flag("--no-cpu", options.no_cpu, "print no CPU times, so that the tables are the same in every run");
  app.add_option("--replay", options.exported_scene, "only export this scene as a scenario of the simulator")
      .type_name("FAMILY:SEED");
  app.add_option("--output", options.output, "file for --replay (default: standard output)").type_name("FILE");
  app.add_option("--search", options.search,
                 "search for scenes in which the arm is touched although a path without contact exists: rest or track")
      .type_name("FAMILY");
  app.add_option("--obstacles", options.obstacles, "obstacles in every scene of --search").show_default().range(1, 5);
  app.add_option("--fastest", options.fastest_mps, "largest speed of the obstacles of --search, m/s")
      .show_default()
      .range(0.3, 5.0)
      .not_nan();
  app.add_option("--scene", options.scene, "run one scene that --search printed, saved in this file").type_name("FILE");
  app.add_option(
         "--problems", options.problems,
         "play MotionBenchMaker's problems in this folder (scene*.yaml, request*.yaml) with the arm of --config")
      .type_name("FOLDER");
  app.add_flag("--mover", options.mover, "add to each of --problems a ball that crosses the arm's way");
  app.add_subcommand("merge", "print the tables of all trials in files of --csv")
      .add_option("files", options.merge, "CSV files")
      .required();
  app.footer(
      "Exit code: 0 done, 2 bad arguments or files, 130 interrupted.\n"
      "The first Ctrl-C lets the scenes in progress end, a second one does not.");
}

struct Shard {
  uint64_t index, count;
};

Shard to_shard(const std::string& text) {
  unsigned index = 0, count = 0;
  char rest = 0;
  const bool good = text.find_first_not_of("0123456789/") == std::string::npos && text.size() < 12 &&
                    std::sscanf(text.c_str(), "%u/%u%c", &index, &count, &rest) == 2;
  if (!good || index < 1 || index > count)
    throw std::runtime_error(fmt::format("--shard: '{}' must be I/N with 1 <= I <= N", text));
  return {index, count};
}

std::vector<Task> tasks_of(const Options& options) {
  const Shard shard = to_shard(options.shard);
  std::vector<Task> tasks;
  for (const Family* family : families_of(options.family)) {
    if (family->posture && options.law != "sidestep")
      throw std::runtime_error(
          fmt::format("--law: {} has posture goals, which only the law sidestep has", family->name));
    if (options.decoys > 0 && !family->dodge) throw std::runtime_error("--decoys: only for dodges");
    for (uint64_t k = shard.index - 1; k < options.count; k += shard.count)
      tasks.push_back({family, scene_seed(options.seed, k)});
  }
  return tasks;
}

std::string default_config() {
  return find_file(config_name("firmware/config/lwa3.yaml"));
}

/// Prints the tables and, with --csv, writes the rows.
void publish(std::vector<Row> rows, const Options& options) {
  sort_rows(rows);
  if (!options.csv.empty()) write_csv(options.csv, rows);
  fmt::print("{}", tables(rows, !options.no_cpu));
  if (options.smoothness) fmt::print("{}", smoothness_table(rows));
}

/// Loads the configuration as the controller would; the default is the LWA3's.
Config config_of(const Options& options) {
  Overrides overrides{options.law == "plain" ? "" : options.law, options.urdf, options.base, options.tip};
  return load_config(options.config.empty() && options.urdf.empty() ? default_config() : options.config, overrides);
}

/// Runs the tasks, with --resume those that are not in the file yet. With --csv each row is written as its trial ends.
std::vector<Row> run_and_record(const std::vector<Task>& tasks, const TestedController& tested,
                                const Options& options) {
  if (options.csv.empty()) {
    if (options.resume) throw std::runtime_error("--resume: --csv is missing");
    return run(tasks, tested, options.jobs, options.quiet, interrupted);
  }
  auto [rows, rest] = options.resume ? resume(options.csv, tasks, tested) : Resumed{{}, tasks};
  MoreColumns more_columns;
  for (const Task& task : tasks) more_columns.include(*task.family);
  CsvWriter writer(options.csv, more_columns, rows);  // fails before the trials if the file cannot be written
  const std::vector<Row> more =
      run(rest, tested, options.jobs, options.quiet, interrupted, [&writer](const Row& row) { writer.add(row); });
  rows.insert(rows.end(), more.begin(), more.end());
  return rows;
}

int run_trials(const Options& options) {
  const std::vector<Task> tasks = tasks_of(options);
  const Config config = config_of(options);
  const std::unique_ptr<JudgeArm> arm = judge_arm_of(config);
  const Model* model = options.law == "plain" ? nullptr : &config.model;
  const TestedController tested{options.law, model, *arm, !options.no_velocities, options.decoys, options.ahead_s};
  const std::vector<Row> rows = run_and_record(tasks, tested, options);
  publish(rows, options);
  if (rows.size() == tasks.size()) return kDone;
  fmt::print(stderr, "campaign: interrupted after {} of {} scenes\n", rows.size(), tasks.size());
  return kInterruptedBySignal;
}

int merge(const Options& options) {
  std::vector<Row> rows;
  for (const std::string& file : options.merge) {
    const std::vector<Row> more = read_csv(file);
    rows.insert(rows.end(), more.begin(), more.end());
  }
  publish(rows, options);
  return kDone;
}

int write_exported_scene(const Options& options) {
  const std::unique_ptr<JudgeArm> arm = judge_arm_of(config_of(options));
  const std::string yaml = export_scene(scene_to_export(options.exported_scene, *arm));
  if (options.output.empty()) {
    fmt::print("{}", yaml);
    return kDone;
  }
  std::ofstream stream(options.output);
  stream << yaml;
  stream.close();
  if (!stream) throw std::runtime_error(fmt::format("{}: cannot be written", options.output));
  return kDone;
}

/// The configuration of a search. Throws std::runtime_error unless its arm is the LWA3.
Config search_config(const Options& options) {
  if (options.law == "plain") throw std::runtime_error("--search, --scene: the law plain ignores obstacles");
  Config config = config_of(options);
  if (dynamic_cast<const Lwa3Arm*>(judge_arm_of(config).get()) == nullptr)
    throw std::runtime_error("--search, --scene: the arm must be the LWA3");
  config.model = model_for(config.model, config.model.arm.limits);
  return config;
}

int run_search(const Options& options) {
  const Config config = search_config(options);
  const SearchSpace space{search_family_named(options.search), options.obstacles, options.fastest_mps,
                          config.model.arm.limits};
  const Shard shard = to_shard(options.shard);
  const SearchPlan plan{options.seed, static_cast<int>(options.count), static_cast<int>(shard.index),
                        static_cast<int>(shard.count)};
  if (!options.csv.empty()) write_findings(options.csv, options.law, {});  // fails before the search
  const SearchResult result = search(space, config.model, plan, options.jobs, options.quiet, interrupted);
  if (!options.csv.empty()) write_findings(options.csv, options.law, result.findings);
  fmt::print("{}", search_report(space, options.law, result));
  if (result.runs == runs_of(plan)) return kDone;
  fmt::print(stderr, "campaign: interrupted after {} of {} runs\n", result.runs, runs_of(plan));
  return kInterruptedBySignal;
}

int run_scene(const Options& options) {
  const Config config = search_config(options);
  const ProvenScene proven = load_proven_scene(options.scene);
  const Limits& limits = config.model.arm.limits;
  const auto controller = make_controller(&config.model, lwa3_arm(), limits);
  fmt::print("{}", scene_report(proven.scene, run_search_trial(proven.scene, *controller),
                                proven_clearance_m(proven.scene, proven.witness, limits)));
  return kDone;
}

/// When interrupted, only some of the problems that get a mover.
std::vector<Problem> add_movers(const std::vector<Problem>& problems, const Config& config, const Options& options) {
  std::vector<Problem> crossed = with_movers(problems, config, options.jobs, options.quiet, interrupted);
  if (interrupted) return crossed;
  if (crossed.empty()) throw std::runtime_error("--mover: no witness was found");
  fmt::print("A ball was added to {} of {} problems; no witness was found for the others.\n", crossed.size(),
             problems.size());
  return crossed;
}

int play_problems(const Options& options) {
  if (options.law == "plain") throw std::runtime_error("--problems: the law plain ignores obstacles");
  const Config config = config_of(options);
  std::vector<Problem> problems = read_problems(options.problems, config.model.arm);
  if (!options.csv.empty()) write_problem_csv(options.csv, {});  // fails before the trials
  const size_t count = problems.size();
  if (options.mover) problems = add_movers(problems, config, options);
  if (interrupted) {
    fmt::print(stderr, "campaign: interrupted before the first of {} problems\n", count);
    return kInterruptedBySignal;
  }
  const std::vector<ProblemResult> results = play(problems, config, options.jobs, options.quiet, interrupted);
  if (!options.csv.empty()) write_problem_csv(options.csv, results);
  if (!results.empty()) fmt::print("{}", problem_table(results));
  if (results.size() == problems.size()) return kDone;
  fmt::print(stderr, "campaign: interrupted after {} of {} problems\n", results.size(), problems.size());
  return kInterruptedBySignal;
}

using Action = int (*)(const Options& options);

Action action_of(const Options& options) {
  if (!options.problems.empty()) return play_problems;
  if (!options.merge.empty()) return merge;
  if (!options.search.empty()) return run_search;
  if (!options.scene.empty()) return run_scene;
  return options.exported_scene.empty() ? run_trials : write_exported_scene;
}

/// Options that ask for another result than the action gives are refused.
int act(const Options& options) {
  const Action action = action_of(options);
  const bool runs_trials = action == run_trials;
  const std::pair<bool, const char*> misplaced[] = {{options.mover && action != play_problems, "--mover"},
                                                    {options.no_velocities && !runs_trials, "--no-velocities"},
                                                    {options.ahead_s > 0.0 && !runs_trials, "--ahead"},
                                                    {options.decoys > 0 && !runs_trials, "--decoys"},
                                                    {options.resume && !runs_trials, "--resume"}};
  for (const auto& [is_misplaced, name] : misplaced)
    if (is_misplaced) throw std::runtime_error(fmt::format("{}: has no effect here, see --help", name));
  return action(options);
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine app(
      "Sidestep's witnessed benchmark: random scenes, each with a witness, a path that proves it solvable; "
      "among people, boxes and in dodges without.");
  Options options;
  declare(app, options);
  if (const auto exit_code = app.parse(argc, argv)) return *exit_code;
  std::signal(SIGINT, interrupt);
  std::signal(SIGTERM, interrupt);
  try {
    return act(options);
  } catch (const std::exception& error) {
    fmt::print(stderr, "campaign: {}\n", error.what());
    return kBadInput;
  }
}
