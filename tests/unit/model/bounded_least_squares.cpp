#include "firmware/model/bounded_least_squares.h"

#include "firmware/model/damped_inverse.h"
#include "tests/support/check.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::Random;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Problem {
  TaskJacobian a;
  TaskVector b;
  double lambda;
  JointVector lower, upper;

  JointVector solve() const { return bounded_least_squares(a, b, lambda, lower, upper); }
  double cost(const JointVector& y) const { return (a * y - b).squaredNorm() + lambda * lambda * y.squaredNorm(); }
};

/// 6 to 10 unknowns; every fifth matrix nearly loses a rank. Bounds are on both sides of 0, beside it, absent or equal.
Problem random_problem(Random& random) {
  const int rows = random.chance(0.5) ? 6 : 3, n = 6 + random.index(5);
  Problem problem{TaskJacobian(rows, n), TaskVector(rows), std::pow(10.0, random.uniform(-3, 0)), JointVector(n),
                  JointVector(n)};
  for (int i = 0; i < rows * n; ++i) problem.a(i / n, i % n) = random.uniform(-1, 1);
  if (random.chance(0.2)) problem.a.row(0) = problem.a.row(1) + 1e-4 * problem.a.row(0);
  for (int i = 0; i < rows; ++i) problem.b[i] = random.uniform(-3, 3);
  for (int i = 0; i < n; ++i) {
    const int kind = random.index(8);
    problem.lower[i] = kind == 0 ? -kInfinity : random.uniform(-1.0, kind == 1 ? 1.0 : 0.0);
    problem.upper[i] = kind == 2 ? kInfinity : kind == 3 ? problem.lower[i] : random.uniform(0.0, 2.0);
    problem.upper[i] = std::max(problem.upper[i], problem.lower[i]);
  }
  return problem;
}

void the_solution_meets_the_optimality_conditions(void**) {
  Random random(1);
  int at_bounds = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const Problem problem = random_problem(random);
    const JointVector y = problem.solve();
    const JointVector slope = problem.a.transpose() * (problem.a * y - problem.b) + problem.lambda * problem.lambda * y;
    for (Eigen::Index i = 0; i < y.size(); ++i) {
      check(y[i] >= problem.lower[i] && y[i] <= problem.upper[i], "trial %d: %g is out of bounds", trial, y[i]);
      const bool low = y[i] <= problem.lower[i], high = y[i] >= problem.upper[i];
      at_bounds += low || high;
      check(low || slope[i] <= 1e-7, "trial %d: unknown %ld should be less, slope %g", trial, i, slope[i]);
      check(high || slope[i] >= -1e-7, "trial %d: unknown %ld should be more, slope %g", trial, i, slope[i]);
    }
  }
  check(at_bounds > 20000, "only %d unknowns at their bounds", at_bounds);
}

void without_active_bounds_it_is_damped_least_squares(void**) {
  Random random(2);
  for (int trial = 0; trial < 1000; ++trial) {
    Problem problem = random_problem(random);
    const JointVector free = damped_solve(problem.a, problem.lambda, problem.b);
    problem.lower = (free.array() - 1e-3).min(0.0);
    problem.upper = (free.array() + 1e-3).max(0.0);
    check_near_because(problem.solve(), free, 1e-9 * (1.0 + free.norm()), "trial %d", trial);
  }
}

void no_clipped_solution_is_better(void**) {
  Random random(3);
  for (int trial = 0; trial < 2000; ++trial) {
    const Problem problem = random_problem(random);
    const JointVector free = damped_solve(problem.a, problem.lambda, problem.b);
    const JointVector clipped = free.cwiseMax(problem.lower).cwiseMin(problem.upper);
    check(problem.cost(problem.solve()) <= problem.cost(clipped) + 1e-9, "trial %d", trial);
  }
}

void a_task_that_is_not_finite_ends(void**) {
  Random random(4);
  Problem problem = random_problem(random);
  problem.b[0] = std::numeric_limits<double>::quiet_NaN();
  assert_false(problem.solve().allFinite());
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(the_solution_meets_the_optimality_conditions),
      cmocka_unit_test(without_active_bounds_it_is_damped_least_squares),
      cmocka_unit_test(no_clipped_solution_is_better),
      cmocka_unit_test(a_task_that_is_not_finite_ends),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
