// The shield's quadratic programme, held to what its answer has to be: allowed, and nearest.
#include "firmware/control/shield/shield_qp.h"

#include <algorithm>

#include "tests/support/check.h"
#include "tests/support/random.h"

using namespace sidestep;
using namespace sidestep::test;

namespace {

/// What giving up a pass row costs, s2/m2.
constexpr double kPassWeight = 1.0 / (3e-2 * 3e-2);

/// A programme whose hard rows some velocity in range meets: they are laid so that a known one does. The others need
/// not be met.
struct Programme {
  JointVector nominal_radps, middle_radps;
  TaskJacobian tool_jacobian;
  VelocityRange range;
  ConstraintRows rows;
  double tool_weight, comfort_weight;

  Programme(int joints, Random& random) {
    tool_jacobian = TaskJacobian(random.chance(0.5) ? 3 : 6, joints);
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
  }

  QpSolution answer() const { return solve(rows, range, {nominal_radps, tool_jacobian, tool_weight, comfort_weight}); }

  bool has_ways() const {
    return std::any_of(rows.begin(), rows.end(), [](const ConstraintRow& row) { return row.tier == Tier::kPass; });
  }
  double objective(const JointVector& velocity_radps) const {
    const JointVector off = velocity_radps - nominal_radps;
    return 0.5 * (off.squaredNorm() + tool_weight * (tool_jacobian * off).squaredNorm());
  }
  double given_up_mps(Tier tier, const JointVector& velocity_radps) const {
    double most_mps = 0.0;
    for (const ConstraintRow& row : rows)
      if (row.tier == tier) most_mps = std::max(most_mps, row.bound - row.row.dot(velocity_radps));
    return most_mps;
  }
  /// With what is given up.
  double cost(const JointVector& velocity_radps) const {
    const double pass_mps = given_up_mps(Tier::kPass, velocity_radps);
    const double comfort_mps = given_up_mps(Tier::kComfort, velocity_radps);
    return objective(velocity_radps) +
           0.5 * (kPassWeight * pass_mps * pass_mps + comfort_weight * comfort_mps * comfort_mps);
  }
  /// How many rows hold an answer back; kNone where the range does so, too.
  static constexpr int kNone = -1;
  int held_by(const JointVector& velocity_radps) const {
    const double rounding = 1e-5;
    const double room_radps =
        std::min((velocity_radps - range.lower_radps).minCoeff(), (range.upper_radps - velocity_radps).minCoeff());
    if (room_radps < rounding) return kNone;
    return static_cast<int>(std::count_if(rows.begin(), rows.end(), [&](const ConstraintRow& row) {
      const double lack_mps = row.bound - row.row.dot(velocity_radps);
      const double most_mps = row.tier == Tier::kHard ? 0.0 : given_up_mps(row.tier, velocity_radps);
      return (row.tier == Tier::kHard || most_mps > rounding) && lack_mps > most_mps - rounding;
    }));
  }
  bool allows(const JointVector& velocity_radps, double rounding) const {
    bool all = ((velocity_radps - range.lower_radps).array() >= -rounding).all() &&
               ((range.upper_radps - velocity_radps).array() >= -rounding).all();
    for (const ConstraintRow& row : rows)
      all = all && (row.tier != Tier::kHard || row.row.dot(velocity_radps) >= row.bound - rounding);
    return all;
  }
};

/// The cost is convex: what no small step lowers is the least. A hard row may give a little, which counts as cost.
void the_answer_is_allowed_and_no_allowed_step_brings_it_nearer(void**) {
  Random random(1);
  int steps = 0, held_by_the_range = 0;
  std::array<int, kMaxRows + 1> held_by{};
  for (int trial = 0; trial < 40000; ++trial) {
    const int joints = 6 + random.index(5);
    const Programme programme(joints, random);
    const QpSolution answer = programme.answer();
    const double give_mps = programme.has_ways() ? 5e-3 : 1e-3;  // pass rows pull harder than comfort
    check(programme.allows(answer.velocity_radps, give_mps), "trial %d: not allowed", trial);
    const double cost = programme.cost(answer.velocity_radps), rounding = 1e-6 * (1.0 + cost);
    check(answer.cost >= cost - rounding, "trial %d: says %g, is %g", trial, answer.cost, cost);
    const int rows = programme.held_by(answer.velocity_radps);
    ++(rows == Programme::kNone ? held_by_the_range : held_by[rows]);
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
  check(held_by_the_range > 100 && held_by[0] > 100 && held_by[1] > 50 && held_by[2] > 50 && held_by[3] > 50 &&
            held_by[4] > 50 && steps > 10000,
        "%d answers held back by the range, %d, %d, %d, %d and %d by none to four rows alone, %d steps tried",
        held_by_the_range, held_by[0], held_by[1], held_by[2], held_by[3], held_by[4], steps);
}

/// Two rows ask for opposite velocities of the first joint: both lose half of what lies between. A third does not use
/// it.
void rows_that_contradict_each_other_do_not_spoil_a_third(void**) {
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
    const QpSolution answer = solve(rows, range, {rest, tool_jacobian, tool_weight, 1.0});
    check_near(answer.velocity_radps[0], 0.0, 1e-3);
    check_near(answer.velocity_radps[1], 0.3, 1e-3);
    check_near(answer.hard_slack_mps, 0.5, 1e-3);
  }
}

/// So that the cycle finds it and stops.
void a_wish_that_is_no_number_is_not_made_one(void**) {
  Random random(2);
  for (int trial = 0; trial < 1000; ++trial) {
    Programme programme(7, random);
    programme.nominal_radps[random.index(7)] = std::numeric_limits<double>::quiet_NaN();
    check(!programme.answer().velocity_radps.allFinite(), "trial %d: %s", trial,
          programme.tool_weight > 0 ? "tool" : "");
  }
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(the_answer_is_allowed_and_no_allowed_step_brings_it_nearer),
      cmocka_unit_test(a_wish_that_is_no_number_is_not_made_one),
      cmocka_unit_test(rows_that_contradict_each_other_do_not_spoil_a_third),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
