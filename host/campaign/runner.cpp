#include "host/campaign/runner.h"

#include <algorithm>
#include <exception>
#include <map>
#include <mutex>
#include <optional>
#include <thread>

#include "host/campaign/progress.h"
#include "host/campaign/scene_maker.h"
#include "host/campaign/statistics.h"
#include "host/campaign/trial.h"

namespace sidestep::campaign {
namespace {

/// State shared by the threads.
class Work {
 public:
  Work(const std::vector<Task>& tasks, const TestedController& tested, bool quiet, const std::atomic<bool>& stop)
      : tasks_(tasks), tested_(tested), stop_(stop), rows_(tasks.size()), progress_(tasks.size(), quiet) {
    for (const Task& task : tasks)
      if (tested.model && models_.count(task.family) == 0)
        models_.emplace(task.family, model_for(*tested.model, tested.arm.limits(*task.family)));
  }

  /// Takes tasks until none is left.
  void run_tasks() {
    for (size_t i; (i = next_++) < tasks_.size() && !stop_ && !failed_;) {
      try {
        rows_[i] = trial(tasks_[i]);
        progress_.add(touched(*rows_[i]), succeeded(*rows_[i]));
      } catch (...) {
        const std::lock_guard<std::mutex> lock(mutex_);
        error_ = std::current_exception();
        failed_ = true;
      }
    }
  }

  std::vector<Row> finished() {
    progress_.end();
    if (error_) std::rethrow_exception(error_);
    std::vector<Row> rows;
    for (const auto& row : rows_)
      if (row) rows.push_back(*row);
    return rows;
  }

 private:
  Row trial(const Task& task) const {
    const Scene scene = make_scene(*task.family, task.seed, tested_.arm);
    const Model* model = tested_.model ? &models_.at(task.family) : nullptr;
    const std::unique_ptr<TrialController> controller =
        make_controller(model, tested_.arm, tested_.arm.limits(*task.family));
    return {task.family, tested_.law, task.seed, run_trial(scene, *controller)};
  }

  const std::vector<Task>& tasks_;
  const TestedController& tested_;
  const std::atomic<bool>& stop_;
  std::map<const Family*, Model> models_;
  std::vector<std::optional<Row>> rows_;
  std::atomic<size_t> next_{0};
  std::atomic<bool> failed_{false};
  std::mutex mutex_;
  std::exception_ptr error_;
  Progress progress_;
};

}  // namespace

uint64_t scene_seed(uint64_t run_seed, uint64_t k) {
  return run_seed * kMostScenes + k;
}

std::vector<Row> run(const std::vector<Task>& tasks, const TestedController& tested, int jobs, bool quiet,
                     const std::atomic<bool>& stop) {
  Work work(tasks, tested, quiet, stop);
  std::vector<std::thread> threads;
  for (int i = 1; i < jobs; ++i) threads.emplace_back([&work] { work.run_tasks(); });
  work.run_tasks();
  for (std::thread& thread : threads) thread.join();
  return work.finished();
}

}  // namespace sidestep::campaign
