#include "host/campaign/resume.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <stdexcept>

namespace sidestep::campaign {
namespace {

using Key = std::pair<const Family*, uint64_t>;

void check_same_run(const std::string& file, const Row& row, const TestedController& tested) {
  const std::atomic<bool> stop{false};
  const std::vector<Row> again = run({{row.family, row.seed}}, tested, 1, true, stop);
  if (!same_result(row, again.front()))
    throw std::runtime_error(
        fmt::format("{}: {}:{} now gives another result: this file is of another arm, "
                    "configuration or version",
                    file, row.family->name, row.seed));
}

}  // namespace

Resumed resume(const std::string& file, const std::vector<Task>& tasks, const TestedController& tested) {
  if (!std::filesystem::exists(file)) return {{}, tasks};
  Resumed resumed{read_interrupted_csv(file), {}};
  std::set<Key> wanted, done;
  for (const Task& task : tasks) wanted.emplace(task.family, task.seed);
  for (const Row& row : resumed.rows) {
    done.emplace(row.family, row.seed);
    if (row.law != tested.law || wanted.count({row.family, row.seed}) == 0)
      throw std::runtime_error(
          fmt::format("{}: {}:{} with law {} is not in this run", file, row.family->name, row.seed, row.law));
  }
  if (!resumed.rows.empty()) check_same_run(file, resumed.rows.front(), tested);
  std::copy_if(tasks.begin(), tasks.end(), std::back_inserter(resumed.rest), [&](const Task& task) {
    return done.count({task.family, task.seed}) == 0;
  });
  return resumed;
}

}  // namespace sidestep::campaign
