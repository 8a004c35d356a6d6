// The shield's quadratic programme, held to what its answer has to be: allowed, and nearest.
#include "firmware/control/shield_qp.h"

#include <algorithm>

#include "tests/support/check.h"
#include "tests/support/random.h"

using namespace sidestep;
using namespace sidestep::test;

namespace {

/// A programme whose hard rows some velocity in range meets: they are laid so that a known one does. Comfort rows need
/// not be met.
struct Programme {
  JointVector wish_radps, middle_radps;
  TaskJacobian tool_jacobian;
  VelocityRange range;
  ShieldRows rows;
  double tool_weight, comfort_weight;

  Programme(int joints, Random& random) {
    tool_jacobian = TaskJacobian(random.chance(0.5) ? 3 : 6, joints);
    for (Eigen::Index i = 0; i < tool_jacobian.size(); ++i) tool_jacobian.data()[i] = random.uniform(-0.4, 0.4);
    tool_weight = random.chance(0.3) ? 0.0 : random.uniform(1, 60);
    comfort_weight = random.chance(0.5) ? random.uniform(0.2, 1) : random.uniform(1, 1000);
    middle_radps = random.joints(joints, -1, 1);
    range = {middle_radps - random.joints(joints, 0.1, 1.5), middle_radps + random.joints(joints, 0.1, 1.5)};
    wish_radps = random.chance(0.5) ? random.joints(joints, -2, 2) : middle_radps + random.joints(joints, -0.3, 0.3);
    for (int i = random.index(random.chance(0.5) ? kMaxRows : 5); i > 0; --i) {
      const JointVector row = random.joints(joints, -1, 1);
      if (random.chance(0.5))
        rows.add({row, row.dot(middle_radps) - random.uniform(0, 0.5), Tier::kHard});
      else
        rows.add({row, row.dot(middle_radps) + random.uniform(-0.5, 0.5), Tier::kComfort});
    }
  }

  QpSolution answer() const { return solve(rows, range, {wish_radps, tool_jacobian, tool_weight, comfort_weight}); }

  double nearness(const JointVector& velocity_radps) const {
    const JointVector off = velocity_radps - wish_radps;
    return 0.5 * (off.squaredNorm() + tool_weight * (tool_jacobian * off).squaredNorm());
  }
  /// With the comfort that is given up.
  double cost(const JointVector& velocity_radps) const {
    double most_mps = 0.0;
    for (const ShieldRow& row : rows)
      if (row.tier == Tier::kComfort) most_mps = std::max(most_mps, row.bound - row.row.dot(velocity_radps));
    return nearness(velocity_radps) + 0.5 * comfort_weight * most_mps * most_mps;
  }
  int missed_by_the_wish() const {
    return static_cast<int>(std::count_if(rows.begin(), rows.end(),
                                          [&](const ShieldRow& row) { return row.row.dot(wish_radps) < row.bound; }));
  }
  bool allows(const JointVector& velocity_radps, double rounding) const {
    bool all = ((velocity_radps - range.lower_radps).array() >= -rounding).all() &&
               ((range.upper_radps - velocity_radps).array() >= -rounding).all();
    for (const ShieldRow& row : rows)
      all = all && (row.tier != Tier::kHard || row.row.dot(velocity_radps) >= row.bound - rounding);
    return all;
  }
};

/// The cost is convex: what no small step lowers is the least. A hard row may give a little, which counts as cost.
void the_answer_is_allowed_and_no_allowed_step_brings_it_nearer(void**) {
  Random random(1);
  const double give_mps = 1e-3;
  int held_back = 0, by_one = 0, steps = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const int joints = 6 + random.index(5);
    const Programme programme(joints, random);
    const QpSolution answer = programme.answer();
    check(programme.allows(answer.velocity_radps, give_mps), "trial %d: not allowed", trial);
    const double cost = programme.cost(answer.velocity_radps), rounding = 1e-6 * (1.0 + cost);
    check(answer.cost >= cost - rounding, "trial %d: says %g, is %g", trial, answer.cost, cost);
    held_back += programme.nearness(answer.velocity_radps) > 1e-9;
    by_one += programme.missed_by_the_wish() == 1;
    for (int i = 0; i < 50; ++i) {
      const JointVector inward = programme.middle_radps - answer.velocity_radps;
      const JointVector elsewhere =
          answer.velocity_radps + random.uniform(0, 0.1) * inward + random.joints(joints, -0.02, 0.02);
      if (!programme.allows(elsewhere, 0.0)) continue;
      ++steps;
      check(programme.cost(elsewhere) >= answer.cost - rounding, "trial %d: %g, and %g would be allowed", trial,
            answer.cost, programme.cost(elsewhere));
    }
  }
  check(held_back > 2000 && by_one > 300 && steps > 10000, "%d wishes held back, %d by one row, %d steps tried",
        held_back, by_one, steps);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(the_answer_is_allowed_and_no_allowed_step_brings_it_nearer),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
