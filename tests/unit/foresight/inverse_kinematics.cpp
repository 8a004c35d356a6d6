#include "firmware/foresight/inverse_kinematics.h"

#include "firmware/model/kinematics.h"
#include "tests/support/check.h"
#include "tests/support/lwa3.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::lwa3;
using test::Random;

namespace {

void solutions_reach_the_target_within_the_limits_from_most_starts(void**) {
  Random random(4);
  int reached = 0, starts = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const LinkPoses goal = forward_kinematics(lwa3(), random.configuration(lwa3(), 0.9));
    Target target;
    target.position_m = goal.tool_position;
    target.tracks_orientation = trial % 2;
    target.orientation = Quaternion(goal.tool_rotation);
    JointVector q_rad = random.configuration(lwa3(), 0.9);
    ++starts;
    if (!solve_ik(lwa3(), target, q_rad)) continue;
    ++reached;
    const LinkPoses found = forward_kinematics(lwa3(), q_rad);
    check((found.tool_position - target.position_m).norm() < 1e-3, "trial %d", trial);
    if (target.tracks_orientation)
      check(Quaternion(found.tool_rotation).angularDistance(target.orientation) < 1.1e-2, "trial %d", trial);
    check((q_rad.array() >= lwa3().limits.lower_rad.array()).all(), "trial %d", trial);
    check((q_rad.array() <= lwa3().limits.upper_rad.array()).all(), "trial %d", trial);
  }
  check(reached > starts / 2, "only %d of %d", reached, starts);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(solutions_reach_the_target_within_the_limits_from_most_starts),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
