#include "firmware/model/load/self_pairs.h"

#include <algorithm>

#include "firmware/control/shield/shield.h"
#include "tests/support/check.h"
#include "tests/support/closed_loop.h"
#include "tests/support/lwa3.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::lwa3;
using test::Random;

namespace {

constexpr double kPeriod_s = 0.01;

using Pairs = std::vector<std::pair<int, int>>;

std::vector<std::string> names(const Arm& arm, const Pairs& pairs) {
  std::vector<std::string> found;
  for (const auto& [a, b] : pairs)
    found.push_back(arm.shapes[static_cast<size_t>(a)].link + " " + arm.shapes[static_cast<size_t>(b)].link);
  std::sort(found.begin(), found.end());
  return found;
}

Proximity measure(const Arm& arm, const LinkPoses& poses, const std::pair<int, int>& pair) {
  return measure_pair(transformed(poses, arm.shapes[static_cast<size_t>(pair.first)]),
                      transformed(poses, arm.shapes[static_cast<size_t>(pair.second)]));
}

void the_lwa3_has_three_pairs_that_can_meet(void**) {
  const std::vector<std::string> expected = {"base_link forearm_link", "base_link hand_link",
                                             "upper_arm_link hand_link"};
  const std::vector<std::string> found = names(lwa3(), find_self_pairs(lwa3()));
  std::string text;
  for (const std::string& name : found) text += name + "; ";
  check(found == expected, "found %s", text.c_str());
}

void the_pairs_are_the_same_on_every_call(void**) {
  const char* const arms[][3] = {{"tests/data/arm6.urdf", "foot", "tip"},
                                 {"tests/data/arm8.urdf", "mount", "flange"},
                                 {"tests/data/arm10.urdf", "l0", "l10"}};
  for (const auto& [file, base, tip] : arms) {
    const Arm arm = load_arm(file, base, tip);
    const Pairs pairs = find_self_pairs(arm);
    assert_true(pairs == find_self_pairs(arm));
    for (const auto& [a, b] : pairs) {
      check(a < b && b < static_cast<int>(arm.shapes.size()), "%s: %d and %d", file, a, b);
      assert_int_not_equal(arm.shapes[static_cast<size_t>(a)].body, arm.shapes[static_cast<size_t>(b)].body);
    }
  }
}

/// A clearance that no configuration has would be demanded in vain in every cycle.
void pairs_that_never_reach_the_clearance_are_overlaps(void**) {
  const size_t all = find_self_pairs(lwa3()).size() + find_overlaps(lwa3()).size();
  check(find_self_pairs(lwa3(), 0.02).size() == 3, "%zu at 2 cm", find_self_pairs(lwa3(), 0.02).size());
  check(find_self_pairs(lwa3(), 2.0).empty(), "%zu at 2 m", find_self_pairs(lwa3(), 2.0).size());
  check(find_overlaps(lwa3(), 2.0).size() == all, "%zu at 2 m", find_overlaps(lwa3(), 2.0).size());
}

/// The nominal velocity that closes the nearest pair as fast as the joints can move.
JointVector folding_nominal(const Arm& arm, const LinkPoses& poses, const Pairs& pairs, double& least_m) {
  JointVector nominal_radps = JointVector::Zero(arm.joints);
  least_m = 1e9;
  for (const auto& pair : pairs) {
    const Proximity now = measure(arm, poses, pair);
    if (now.distance_m >= least_m) continue;
    least_m = now.distance_m;
    const int first = arm.shapes[static_cast<size_t>(pair.first)].body;
    const int second = arm.shapes[static_cast<size_t>(pair.second)].body;
    const JointVector opening =
        (point_jacobian(poses, first, now.on_arm) - point_jacobian(poses, second, now.on_obstacle)).transpose() *
        now.normal;
    nominal_radps = -opening * (2.0 / std::max(1e-6, opening.cwiseAbs().maxCoeff()));
  }
  return nominal_radps;
}

void a_nominal_velocity_that_folds_the_arm_onto_itself_leads_to_no_contact(void**) {
  const Model model = test::lwa3_model("sidestep");
  const auto nothing = std::make_unique<ObstacleSet>();
  const ObstacleView view{nothing.get(), 0.0, 0.0};
  Random random(1);
  int met = 0;
  for (int trial = 0; trial < 60; ++trial) {
    JointVector q_rad = random.configuration(model.arm, 0.95), last_radps = JointVector::Zero(7);
    double least_m = 0.0, nearest_m = 1.0;
    folding_nominal(model.arm, forward_kinematics(model.arm, q_rad), model.self_pairs, least_m);
    if (least_m < 0.05) continue;
    for (int cycle = 0; cycle < 300; ++cycle) {
      const LinkPoses poses = forward_kinematics(model.arm, q_rad);
      const JointVector nominal_radps = folding_nominal(model.arm, poses, model.self_pairs, least_m);
      check(least_m >= 0.0, "trial %d, cycle %d: %g m", trial, cycle, least_m);
      nearest_m = std::min(nearest_m, least_m);
      const Clearance clearance = measure_clearance(model.arm, poses, view, {0.0, 0.0});
      const ShieldInput around{model.arm,        poses,      q_rad, last_radps, clearance, view,
                               model.self_pairs, last_radps, 0.01,  1.0};
      last_radps = shield(model.settings.shield, around, sustainable_range(model.arm.limits, q_rad, q_rad, kPeriod_s),
                          velocity_range(model.arm.limits, q_rad, q_rad, last_radps, kPeriod_s),
                          tool_jacobian(poses, 3), nominal_radps)
                       .velocity_radps;
      q_rad += kPeriod_s * last_radps;
    }
    if (nearest_m < 0.03) ++met;
  }
  check(met >= 5, "only %d came near", met);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(the_lwa3_has_three_pairs_that_can_meet),
      cmocka_unit_test(the_pairs_are_the_same_on_every_call),
      cmocka_unit_test(pairs_that_never_reach_the_clearance_are_overlaps),
      cmocka_unit_test(a_nominal_velocity_that_folds_the_arm_onto_itself_leads_to_no_contact),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
