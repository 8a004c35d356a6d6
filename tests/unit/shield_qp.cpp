// The shield's quadratic programme, held to what its answer has to be: allowed, and nearest.
#include "firmware/control/shield_qp.h"

#include "tests/support/check.h"
#include "tests/support/random.h"

using namespace sidestep;
using namespace sidestep::test;

namespace {

/// A programme that some velocity in range meets: rows are laid so that a known one does.
struct Programme {
  JointVector wish_radps, middle_radps;
  TaskJacobian tool_jacobian;
  VelocityRange range;
  ShieldRows rows;
  double tool_weight;

  Programme(int joints, Random& random) {
    wish_radps = random.joints(joints, -2, 2);
    tool_jacobian = TaskJacobian(random.chance(0.5) ? 3 : 6, joints);
    for (Eigen::Index i = 0; i < tool_jacobian.size(); ++i) tool_jacobian.data()[i] = random.uniform(-0.4, 0.4);
    tool_weight = random.chance(0.3) ? 0.0 : random.uniform(1, 60);
    middle_radps = random.joints(joints, -1, 1);
    range = {middle_radps - random.joints(joints, 0.1, 1.5), middle_radps + random.joints(joints, 0.1, 1.5)};
    for (int i = random.index(kMaxRows); i > 0; --i) {
      const JointVector row = random.joints(joints, -1, 1);
      rows.add({row, row.dot(middle_radps) - random.uniform(0, 0.5), Tier::kHard});
    }
  }

  QpSolution answer() const { return solve(rows, range, {wish_radps, tool_jacobian, tool_weight, 1.0}); }

  double cost(const JointVector& velocity_radps) const {
    const JointVector off = velocity_radps - wish_radps;
    return 0.5 * (off.squaredNorm() + tool_weight * (tool_jacobian * off).squaredNorm());
  }
  bool allows(const JointVector& velocity_radps, double rounding) const {
    bool all = ((velocity_radps - range.lower_radps).array() >= -rounding).all() &&
               ((range.upper_radps - velocity_radps).array() >= -rounding).all();
    for (const ShieldRow& row : rows) all = all && row.row.dot(velocity_radps) >= row.bound - rounding;
    return all;
  }
};

/// The cost is convex: what no small step lowers is the least. A hard row may give a little, which counts as cost.
void the_answer_is_allowed_and_no_allowed_step_brings_it_nearer(void**) {
  Random random(1);
  const double give_mps = 1e-3;
  int held_back = 0, steps = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const int joints = 6 + random.index(5);
    const Programme programme(joints, random);
    const QpSolution answer = programme.answer();
    check(programme.allows(answer.velocity_radps, give_mps), "trial %d: not allowed", trial);
    const double nearness = programme.cost(answer.velocity_radps), rounding = 1e-6 * (1.0 + nearness);
    check(answer.cost >= nearness - rounding, "trial %d: says %g, is %g", trial, answer.cost, nearness);
    held_back += nearness > 1e-9;
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
  check(held_back > 2000 && steps > 10000, "%d wishes held back, %d steps tried", held_back, steps);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(the_answer_is_allowed_and_no_allowed_step_brings_it_nearer),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
