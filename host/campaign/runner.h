#pragma once

#include <atomic>

#include "firmware/control/cycle.h"
#include "host/campaign/csv.h"
#include "host/campaign/lwa3_arm.h"

namespace sidestep::campaign {

struct Task {
  const Family* family;
  uint64_t seed;
};

/// Scene k of a run with a seed; k below kMostScenes.
constexpr uint64_t kMostScenes = 1'000'000;
uint64_t scene_seed(uint64_t run_seed, uint64_t k);

/// Who steers: the configured controller under the name of its law, or plain tracking when there is none; and what.
struct Entrant {
  std::string law;
  const Model* model;
  const JudgeArm& arm = lwa3_arm();
};

/// Runs all tasks on `jobs` threads; the rows come in the order of the tasks and do not depend on the threads, CPU
/// times excepted. When `stop` is raised the trials under way are finished and the rest is left out. Progress goes to
/// stderr unless quiet.
std::vector<Row> run(const std::vector<Task>& tasks, const Entrant& entrant, int jobs, bool quiet,
                     const std::atomic<bool>& stop);

}  // namespace sidestep::campaign
