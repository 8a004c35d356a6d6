#include "host/campaign/furniture/path_planner.h"

#include <thread>

#include "tests/support/check.h"

using namespace sidestep::campaign;

namespace {

/// Two joints and a wall between start and goal, with a gap of 0.2 rad at its end if there is any.
PlanningProblem wall(bool gap, uint32_t seed) {
  PlanningProblem problem;
  problem.start_rad = Joints::Constant(2, 0.0);
  problem.goal_rad = Joints::Constant(2, 0.0);
  problem.start_rad[0] = -1.0;
  problem.goal_rad[0] = 1.0;
  problem.range.lower_rad = Joints::Constant(2, -2.0);
  problem.range.upper_rad = Joints::Constant(2, 2.0);
  problem.is_valid = [gap](const Joints& q_rad) { return std::abs(q_rad[0]) > 0.1 || (gap && q_rad[1] > 1.8); };
  problem.seed = seed;
  problem.most_checks = 20'000;
  return problem;
}

void a_path_leads_through_the_only_gap(void**) {
  for (uint32_t seed = 1; seed <= 20; ++seed) {
    const PlanningProblem problem = wall(true, seed);
    const std::vector<Joints> path = plan_path(problem);
    check(path.size() >= 3, "seed %u: %zu postures", seed, path.size());
    check_near(path.front(), problem.start_rad, 0.0);
    check_near(path.back(), problem.goal_rad, 0.0);
    double length_rad = 0.0;
    for (size_t i = 1; i < path.size(); ++i) {
      length_rad += (path[i] - path[i - 1]).norm();
      for (double share = 0.0; share <= 1.0; share += 0.001) {
        const Joints q_rad = path[i - 1] + share * (path[i] - path[i - 1]);
        // Between two checks the path may cut the corner of the gap by less than a step.
        check(std::abs(q_rad[0]) > 0.1 - kPlannedStep_rad || q_rad[1] > 1.8 - kPlannedStep_rad, "seed %u", seed);
        check(q_rad.cwiseAbs().maxCoeff() <= 2.0, "seed %u: beyond the range", seed);
      }
    }
    check(length_rad > 4.0 && length_rad < 6.0, "seed %u: %g rad, the shortest has 4.2", seed, length_rad);
  }
}

void without_a_gap_there_is_no_path(void**) {
  int checks = 0;
  PlanningProblem problem = wall(false, 1);
  problem.is_valid = [&checks, is_valid = problem.is_valid](const Joints& q_rad) {
    ++checks;
    return is_valid(q_rad);
  };
  check(plan_path(problem).empty(), "a path leads through the wall");
  check(checks >= problem.most_checks && checks < problem.most_checks + 100, "%d checks", checks);
}

void the_same_problem_gives_the_same_path_in_every_thread(void**) {
  const std::vector<Joints> one = plan_path(wall(true, 5));
  std::vector<std::vector<Joints>> others(4);
  std::vector<std::thread> threads;
  for (std::vector<Joints>& other : others) threads.emplace_back([&other] { other = plan_path(wall(true, 5)); });
  for (std::thread& thread : threads) thread.join();
  for (const std::vector<Joints>& other : others) {
    check(other.size() == one.size(), "%zu and %zu postures", other.size(), one.size());
    for (size_t i = 0; i < one.size(); ++i) check_near(other[i], one[i], 0.0);
  }
  const std::vector<Joints> another = plan_path(wall(true, 6));
  check(another.size() != one.size() || (another[1] - one[1]).norm() > 1e-6, "the seed changes nothing");
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_path_leads_through_the_only_gap),
      cmocka_unit_test(without_a_gap_there_is_no_path),
      cmocka_unit_test(the_same_problem_gives_the_same_path_in_every_thread),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
