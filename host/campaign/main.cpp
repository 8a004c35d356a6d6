#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <thread>

#include "firmware/base/command_line.h"
#include "firmware/base/find_file.h"
#include "firmware/io/config/config.h"
#include "host/campaign/config_name.h"
#include "host/campaign/runner.h"
#include "host/campaign/scene_export.h"
#include "host/campaign/table.h"

namespace {

using namespace sidestep;
using namespace sidestep::campaign;

enum ExitCode { kDone = 0, kBadInput = 2, kInterruptedBySignal = 130 };

std::atomic<bool> interrupted{false};

struct Options {
  std::string family = "all", law = "sidestep", config, urdf, base, tip, shard = "1/1", csv, replay, output;
  uint64_t count = 500, seed = 1;
  int jobs = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  bool quiet = false, smoothness = false, no_cpu = false;
  std::vector<std::string> merge;
};

void declare(CommandLine& app, Options& options) {
  app.add_option("--family", options.family,
                 "moving, fast, crowd, clutter, chase, erratic, real, follow6d, chase6d, dodge, or all")
      .show_default();
  app.add_option("--count", options.count, "scenes of each family")
      .show_default()
      .range(1, static_cast<int>(kMostScenes));
  app.add_option("--seed", options.seed, "of the run; the scenes' own seeds follow from it")
      .show_default()
      .range(0, 1'000'000'000);
  app.add_option("--law", options.law, "sidestep, paper, or plain (attraction only)")
      .show_default()
      .one_of({"sidestep", "paper", "plain"});
  app.add_option("--config", options.config, "of the controller and its arm (default: the LWA3's)").type_name("FILE");
  app.add_option("--urdf", options.urdf, "of the arm, over what the configuration says; alone: the rest is default")
      .type_name("FILE");
  app.add_option("--base", options.base, "first link of the arm").type_name("LINK");
  app.add_option("--tip", options.tip, "last link of the arm").type_name("LINK");
  app.add_option("--shard", options.shard, "only every n-th scene, from the i-th on").show_default().type_name("I/N");
  app.add_option("--csv", options.csv, "one row per trial into this file").type_name("FILE");
  app.add_option("--jobs", options.jobs, "threads").show_default().range(1, 256);
  app.add_flag("--quiet", options.quiet, "no progress");
  app.add_flag("--smoothness", options.smoothness, "also tell how smooth the commands were");
  app.add_flag("--no-cpu", options.no_cpu, "leave the CPU times out; the rest is the same in every run");
  app.add_option("--replay", options.replay, "write this one scene as a scenario of the simulator")
      .type_name("FAMILY:SEED");
  app.add_option("--output", options.output, "of --replay (default: standard output)").type_name("FILE");
  app.add_subcommand("merge", "the tables of all trials in these --csv files")
      .add_option("files", options.merge, "CSV files")
      .required();
  app.footer("Exit code: 0 done, 2 bad arguments or files, 130 interrupted.");
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
    throw std::runtime_error(fmt::format("--shard: must be i/n with 1 <= i <= n, is '{}'", text));
  return {index, count};
}

std::vector<Task> tasks_of(const Options& options) {
  const Shard shard = to_shard(options.shard);
  std::vector<Task> tasks;
  for (const Family* family : families_of(options.family))
    for (uint64_t k = shard.index - 1; k < options.count; k += shard.count)
      tasks.push_back({family, scene_seed(options.seed, k)});
  return tasks;
}

std::string default_config() {
  return find_file(config_name("firmware/config/lwa3.yaml"));
}

/// The tables on standard output, and the rows where they are wanted.
void publish(std::vector<Row> rows, const Options& options) {
  sort_rows(rows);
  if (!options.csv.empty()) write_csv(options.csv, rows);
  fmt::print("{}", tables(rows, !options.no_cpu));
  if (options.smoothness) fmt::print("{}", smoothness_table(rows));
}

/// As the controller itself would have it; for the benchmark's own arm if nothing is said.
Config config_of(const Options& options) {
  Overrides overrides{options.law == "plain" ? "" : options.law, options.urdf, options.base, options.tip};
  return load_config(options.config.empty() && options.urdf.empty() ? default_config() : options.config, overrides);
}

int run_trials(const Options& options) {
  const std::vector<Task> tasks = tasks_of(options);
  const Config config = config_of(options);
  const std::unique_ptr<JudgeArm> arm = judge_arm_of(config);
  if (!options.csv.empty()) write_csv(options.csv, {});  // fail now rather than after the work
  const Entrant entrant{options.law, options.law == "plain" ? nullptr : &config.model, *arm};
  const std::vector<Row> rows = run(tasks, entrant, options.jobs, options.quiet, interrupted);
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

int write_replay(const Options& options) {
  const std::unique_ptr<JudgeArm> arm = judge_arm_of(config_of(options));
  const std::string yaml = scenario_yaml(scene_named(options.replay, *arm));
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

int act(const Options& options) {
  if (!options.merge.empty()) return merge(options);
  return options.replay.empty() ? run_trials(options) : write_replay(options);
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine app("Sidestep's witnessed benchmark: random scenes, each of which provably has a solution.");
  Options options;
  declare(app, options);
  if (const auto exit_code = app.parse(argc, argv)) return *exit_code;
  std::signal(SIGINT, [](int) { interrupted = true; });
  std::signal(SIGTERM, [](int) { interrupted = true; });
  try {
    return act(options);
  } catch (const std::exception& error) {
    fmt::print(stderr, "campaign: {}\n", error.what());
    return kBadInput;
  }
}
