#pragma once

#include <atomic>
#include <functional>

#include "firmware/control/cycle.h"
#include "host/campaign/csv.h"
#include "host/campaign/lwa3_arm.h"

namespace sidestep::campaign {

struct Task {
  const Family* family;
  uint64_t seed;
};

/// Seed of scene k of a run; k below kMostScenes.
constexpr uint64_t kMostScenes = 1'000'000;
uint64_t scene_seed(uint64_t run_seed, uint64_t k);

/// The controller under test and its arm.
struct TestedController {
  std::string law;     ///< name in the tables
  const Model* model;  ///< null: plain tracking
  const JudgeArm& arm = lwa3_arm();
  bool velocities = true;  ///< of the obstacles are reported to it
  int decoys = 0;          ///< more obstacles in each dodge
  double ahead_s = 0.0;    ///< all obstacles are reported as they will be so much later
};

/// Runs all tasks on `jobs` threads. The rows are in the order of the tasks and, except for CPU times, do not depend on
/// the threads. When `stop` becomes true the trials in progress are finished and the rest is skipped. Progress is
/// printed on stderr unless quiet. `ended` is called with each row, from any of the threads.
std::vector<Row> run(const std::vector<Task>& tasks, const TestedController& tested, int jobs, bool quiet,
                     const std::atomic<bool>& stop, const std::function<void(const Row&)>& ended = {});

}  // namespace sidestep::campaign
