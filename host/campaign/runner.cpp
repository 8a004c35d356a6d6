#include "host/campaign/runner.h"

#include <map>
#include <optional>

#include "host/campaign/decoys.h"
#include "host/campaign/parallel.h"
#include "host/campaign/progress.h"
#include "host/campaign/scene_maker.h"
#include "host/campaign/statistics.h"
#include "host/campaign/trial.h"

namespace sidestep::campaign {
namespace {

Row trial(const Task& task, const TestedController& tested, const Model* model) {
  Scene scene = make_scene(*task.family, task.seed, tested.arm);
  scene.reports_velocities = tested.velocities;
  scene.ahead_s = tested.ahead_s;
  if (tested.decoys > 0) add_decoys(scene, tested.decoys);
  const std::unique_ptr<TrialController> controller =
      make_controller(model, tested.arm, tested.arm.limits(*task.family));
  return {task.family, tested.law, task.seed, run_trial(scene, *controller)};
}

}  // namespace

uint64_t scene_seed(uint64_t run_seed, uint64_t k) {
  return run_seed * kMostScenes + k;
}

std::vector<Row> run(const std::vector<Task>& tasks, const TestedController& tested, int jobs, bool quiet,
                     const std::atomic<bool>& stop, const std::function<void(const Row&)>& ended) {
  std::map<const Family*, Model> models;
  for (const Task& task : tasks)
    if (tested.model && models.count(task.family) == 0)
      models.emplace(task.family, model_for(*tested.model, tested.arm.limits(*task.family)));
  std::vector<std::optional<Row>> rows(tasks.size());
  Progress progress(tasks.size(), quiet);
  run_parallel(tasks.size(), jobs, stop, [&](size_t i) {
    const Model* model = tested.model ? &models.at(tasks[i].family) : nullptr;
    rows[i] = trial(tasks[i], tested, model);
    if (ended) ended(*rows[i]);
    progress.add(touched(*rows[i]), succeeded(*rows[i]));
  });
  std::vector<Row> finished;
  for (const auto& row : rows)
    if (row) finished.push_back(*row);
  return finished;
}

}  // namespace sidestep::campaign
