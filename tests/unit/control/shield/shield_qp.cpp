// The shield's quadratic programme, checked against the definition of its solution: feasible and of least cost.
#include "firmware/control/shield/shield_qp.h"

#include <algorithm>

#include "tests/support/check.h"
#include "tests/support/random.h"

using namespace sidestep;
using namespace sidestep::test;

namespace {

/// Weight of the squared slack of the pass rows, s2/m2.
constexpr double kPassWeight = 1.0 / (3e-2 * 3e-2);

/// A random programme, a third of them with prismatic joints. middle_radps is within the range and meets all hard rows;
/// the other rows may conflict.
struct Programme {
  JointVector nominal_radps, middle_radps, scale;
  TaskJacobian tool_jacobian;
  VelocityRange range;
  ConstraintRows rows;
  double tool_weight, comfort_weight;

  Programme(int joints, Random& random) : tool_jacobian(random.chance(0.5) ? 3 : 6, joints) {
    for (Eigen::Index i = 0; i < tool_jacobian.size(); ++i) tool_jacobian.data()[i] = random.uniform(-0.4, 0.4);
    tool_weight = random.chance(0.3) ? 0.0 : random.uniform(1, 60);
    comfort_weight = random.chance(0.5) ? random.uniform(0.2, 1) : random.uniform(1, 1000);
    middle_radps = random.joints(joints, -1, 1);
    range = {middle_radps - random.joints(joints, 0.1, 1.5), middle_radps + random.joints(joints, 0.1, 1.5)};
    nominal_radps = random.chance(0.5) ? random.joints(joints, -2, 2) : middle_radps + random.joints(joints, -0.3, 0.3);
    for (int i = random.index(random.chance(0.5) ? kMaxRows : 5); i > 0; --i) {
      const JointVector row = random.joints(joints, -1, 1);
      if (random.chance(0.5))
        rows.add({row, row.dot(middle_radps) - random.uniform(0, 0.5), Tier::kHard});
      else
        rows.add({row, row.dot(middle_radps) + random.uniform(-0.5, 0.5),
                  random.chance(0.5) ? Tier::kPass : Tier::kComfort});
    }
    scale = JointVector::Ones(joints);
    if (random.chance(0.67)) return;
    for (double& of_joint : scale)
      if (random.chance(0.3)) of_joint = 0.25;
  }

  QpSolution solution() const {
    return solve(rows, range, {nominal_radps, tool_jacobian, tool_weight, comfort_weight, &scale});
  }

  bool has_pass_rows() const {
    return std::any_of(rows.begin(), rows.end(), [](const ConstraintRow& row) { return row.tier == Tier::kPass; });
  }
  double objective(const JointVector& velocity_radps) const {
    const JointVector change_radps = velocity_radps - nominal_radps;
    return 0.5 * (change_radps.cwiseQuotient(scale).squaredNorm() +
                  tool_weight * (tool_jacobian * change_radps).squaredNorm());
  }
  double slack_mps(Tier tier, const JointVector& velocity_radps) const {
    double most_mps = 0.0;
    for (const ConstraintRow& row : rows)
      if (row.tier == tier) most_mps = std::max(most_mps, row.bound - row.row.dot(velocity_radps));
    return most_mps;
  }
  /// The objective with the cost of the slack.
  double cost(const JointVector& velocity_radps) const {
    const double pass_mps = slack_mps(Tier::kPass, velocity_radps);
    const double comfort_mps = slack_mps(Tier::kComfort, velocity_radps);
    return objective(velocity_radps) +
           0.5 * (kPassWeight * pass_mps * pass_mps + comfort_weight * comfort_mps * comfort_mps);
  }
  /// Number of active rows at a solution; kRangeActive where a limit of the range is active, too.
  static constexpr int kRangeActive = -1;
  int active_rows(const JointVector& velocity_radps) const {
    const double rounding = 1e-5;
    const double room_radps =
        std::min((velocity_radps - range.lower_radps).minCoeff(), (range.upper_radps - velocity_radps).minCoeff());
    if (room_radps < rounding) return kRangeActive;
    return static_cast<int>(std::count_if(rows.begin(), rows.end(), [&](const ConstraintRow& row) {
      const double shortfall_mps = row.bound - row.row.dot(velocity_radps);
      const double most_mps = row.tier == Tier::kHard ? 0.0 : slack_mps(row.tier, velocity_radps);
      return (row.tier == Tier::kHard || most_mps > rounding) && shortfall_mps > most_mps - rounding;
    }));
  }
  bool is_feasible(const JointVector& velocity_radps, double rounding) const {
    bool all = ((velocity_radps - range.lower_radps).array() >= -rounding).all() &&
               ((range.upper_radps - velocity_radps).array() >= -rounding).all();
    for (const ConstraintRow& row : rows)
      all = all && (row.tier != Tier::kHard || row.row.dot(velocity_radps) >= row.bound - rounding);
    return all;
  }
};

/// The cost is convex, so a cost that no small step lowers is the least. A hard row may keep a small slack, whose cost
/// counts.
void the_solution_is_feasible_and_no_feasible_step_lowers_its_cost(void**) {
  Random random(1);
  int steps = 0, range_active = 0;
  std::array<int, kMaxRows + 1> active_rows{};
  for (int trial = 0; trial < 40000; ++trial) {
    const int joints = 6 + random.index(5);
    const Programme programme(joints, random);
    const QpSolution solution = programme.solution();
    const double most_slack_mps = programme.has_pass_rows() ? 5e-3 : 1e-3;  // pass rows weigh more than comfort rows
    check(programme.is_feasible(solution.velocity_radps, most_slack_mps), "trial %d: not feasible", trial);
    const double cost = programme.cost(solution.velocity_radps), rounding = 1e-6 * (1.0 + cost);
    check(solution.cost >= cost - rounding, "trial %d: cost %g reported, %g computed", trial, solution.cost, cost);
    const int rows = programme.active_rows(solution.velocity_radps);
    ++(rows == Programme::kRangeActive ? range_active : active_rows[rows]);
    for (int i = 0; i < 50; ++i) {
      const JointVector inward = programme.middle_radps - solution.velocity_radps;
      const JointVector other_radps =
          solution.velocity_radps + random.uniform(0, 0.1) * inward + random.joints(joints, -0.02, 0.02);
      if (!programme.is_feasible(other_radps, 0.0)) continue;
      ++steps;
      check(programme.cost(other_radps) >= solution.cost - rounding, "trial %d: cost %g, a feasible step costs %g",
            trial, solution.cost, programme.cost(other_radps));
    }
  }
  check(range_active > 100 && active_rows[0] > 100 && active_rows[1] > 50 && active_rows[2] > 50 &&
            active_rows[3] > 50 && active_rows[4] > 50 && steps > 10000,
        "%d solutions at the range, %d, %d, %d, %d and %d with none to four active rows only, %d steps", range_active,
        active_rows[0], active_rows[1], active_rows[2], active_rows[3], active_rows[4], steps);
}

/// Two rows demand opposite velocities of the first joint; each gets half of their difference as slack. The third row
/// must not use that slack.
void two_conflicting_rows_do_not_relax_a_third(void**) {
  const int joints = 7;
  const JointVector rest = JointVector::Zero(joints), one = JointVector::Unit(joints, 0);
  const JointVector another = JointVector::Unit(joints, 1);
  const VelocityRange range{JointVector::Constant(joints, -1), JointVector::Constant(joints, 1)};
  ConstraintRows rows;
  rows.add({one, 0.5, Tier::kHard});
  rows.add({-one, 0.5, Tier::kHard});
  rows.add({another, 0.3, Tier::kHard});
  for (const double tool_weight : {0.0, 25.0}) {
    const TaskJacobian tool_jacobian = TaskJacobian::Identity(3, joints);
    const QpSolution solution = solve(rows, range, {rest, tool_jacobian, tool_weight, 1.0});
    check_near(solution.velocity_radps[0], 0.0, 1e-3);
    check_near(solution.velocity_radps[1], 0.3, 1e-3);
    check_near(solution.hard_slack_mps, 0.5, 1e-3);
  }
}

/// A row with an infinite bound has no finite slack.
void a_programme_without_a_solution_stops_as_fast_as_the_range_permits(void**) {
  Random random(3);
  for (int trial = 0; trial < 1000; ++trial) {
    const int joints = 6 + random.index(5);
    Programme programme(joints, random);
    if (programme.rows.is_full()) continue;
    programme.rows.add({random.joints(joints, -1, 1), HUGE_VAL, random.chance(0.5) ? Tier::kHard : Tier::kPass});
    const QpSolution solution = programme.solution();
    const JointVector stop_radps =
        JointVector::Zero(joints).cwiseMax(programme.range.lower_radps).cwiseMin(programme.range.upper_radps);
    check(solution.failed, "trial %d: solved", trial);
    check_near(solution.velocity_radps, stop_radps, 0);
  }
}

/// The cycle detects the solution that is not finite and raises a fault.
void a_nominal_velocity_that_is_not_a_number_gives_no_finite_solution(void**) {
  Random random(2);
  for (int trial = 0; trial < 1000; ++trial) {
    Programme programme(7, random);
    programme.nominal_radps[random.index(7)] = std::numeric_limits<double>::quiet_NaN();
    check(!programme.solution().velocity_radps.allFinite(), "trial %d: tool weight %g", trial, programme.tool_weight);
  }
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(the_solution_is_feasible_and_no_feasible_step_lowers_its_cost),
      cmocka_unit_test(a_nominal_velocity_that_is_not_a_number_gives_no_finite_solution),
      cmocka_unit_test(a_programme_without_a_solution_stops_as_fast_as_the_range_permits),
      cmocka_unit_test(two_conflicting_rows_do_not_relax_a_third),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
