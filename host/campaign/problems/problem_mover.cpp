#include "host/campaign/problems/problem_mover.h"

#include <algorithm>
#include <map>
#include <memory>

#include "host/campaign/furniture/mover.h"
#include "host/campaign/furniture/witness_plan.h"
#include "host/campaign/parallel.h"
#include "host/campaign/problems/problem_config.h"
#include "host/campaign/progress.h"

namespace sidestep::campaign {
namespace {

constexpr double kClearance_m = 0.002;  // of the witness: the problems' goals are tight
constexpr int kTries = 5;

bool add_mover(Problem& problem, const JudgeArm& arm) {
  Random random(problem.kind + " " + problem.name, 1);
  Scene scene{};
  scene.family = &family_named("shelf@mover");  // for the ball's speed
  scene.arm = &arm;
  scene.start_rad = problem.start_rad;
  scene.goal_rad = problem.goal_rad;
  scene.furniture = problem.obstacles;
  scene.periods = static_cast<int>(kProblemDuration_s / kPeriod_s);
  for (int attempt = 0; attempt < kTries; ++attempt) {
    if (!plan_witness(random, scene, kClearance_m) || !draw_mover(random, scene)) continue;
    problem.kind += "@mover";
    problem.mover = scene.spheres.front();
    return true;
  }
  return false;
}

}  // namespace

std::vector<Problem> with_movers(const std::vector<Problem>& problems, const Config& config, int jobs, bool quiet,
                                 const std::atomic<bool>& stop) {
  std::map<JointPositions, std::unique_ptr<JudgeArm>> arms;
  for (const Problem& problem : problems)
    if (std::unique_ptr<JudgeArm>& arm = arms[problem.other_positions]; !arm)
      arm = judge_arm_of(config_for(problem, config));
  std::vector<Problem> crossed = problems;
  Progress progress(problems.size(), quiet);
  run_parallel(problems.size(), jobs, stop, [&](size_t i) {
    const bool found = add_mover(crossed[i], *arms.at(problems[i].other_positions));
    progress.add(false, found);
  });
  crossed.erase(std::remove_if(crossed.begin(), crossed.end(), [](const Problem& p) { return !p.mover; }),
                crossed.end());
  return crossed;
}

}  // namespace sidestep::campaign
