#include "host/campaign/problems/problem_trial.h"

#include "host/campaign/problems/problem_mover.h"
#include "host/campaign/problems/problem_table.h"
#include "host/campaign/scene.h"
#include "tests/support/check.h"

using namespace sidestep;
using namespace sidestep::campaign;

namespace {

std::vector<ProblemResult> results_of(const std::vector<Problem>& problems, const Config& config) {
  const std::atomic<bool> stop{false};
  return play(problems, config, 2, true, stop);
}

/// From above it to below it. Foresight's planner finds the way, the law alone wanders about for 8 s.
void the_arm_reaches_under_a_table(void**) {
  Config config = load_config("firmware/config/panda.yaml", {});
  const std::vector<Problem> problems = read_problems("tests/data/problems", config.model.arm);
  const ProblemResult planned = results_of(problems, config)[0];
  check(planned.kind == "under-table" && planned.name == "0001", "%s %s", planned.kind.c_str(), planned.name.c_str());
  check(planned.arrived(0.005) && !planned.touched(), "%g m away, %g m clear", planned.error_m, planned.clearance_m);
  check(planned.arrival_s < 2.5, "after %g s", planned.arrival_s);
  check(planned.guided > 0.5, "guided for %g of the time", planned.guided);
  config.model.settings.foresight.enabled = false;
  const ProblemResult alone = results_of(problems, config)[0];
  check(!alone.touched() && alone.guided == 0.0, "%g m clear", alone.clearance_m);
  check(alone.arrival_s > 5.0, "the law alone arrives after %g s: the problem shows nothing", alone.arrival_s);
}

const std::atomic<bool> kGoOn{false};

void a_ball_that_crosses_the_way_is_evaded(void**) {
  const Config config = load_config("firmware/config/panda.yaml", {});
  const std::vector<Problem> problems = read_problems("tests/data/problems", config.model.arm);
  const std::vector<Problem> crossed = with_movers(problems, config, 1, true, kGoOn);
  assert_int_equal(crossed.size(), 1);
  assert_string_equal(crossed[0].kind.c_str(), "under-table@mover");
  check_near(with_movers(problems, config, 1, true, kGoOn)[0].mover->at(1.0).position_m,
             crossed[0].mover->at(1.0).position_m, 0.0);
  const ProblemResult result = results_of(crossed, config)[0];
  check(result.arrived(0.01) && !result.touched(), "%g m away, %g m clear", result.error_m, result.mover_clearance_m);
  check(result.mover_clearance_m < 0.5, "%g m: it never came near", result.mover_clearance_m);
}

/// It flies through the first link, which cannot evade.
void contact_with_the_ball_is_seen(void**) {
  const Config config = load_config("firmware/config/panda.yaml", {});
  std::vector<Problem> problems = read_problems("tests/data/problems", config.model.arm);
  problems[0].mover = SpherePath({-0.5, 0.0, 0.2}, {0.5, 0.0, 0.0});
  const ProblemResult result = results_of(problems, config)[0];
  check(result.touched() && result.mover_clearance_m < 0.0 && result.clearance_m > 0.0, "%g m, %g m",
        result.mover_clearance_m, result.clearance_m);
}

void the_table_counts_what_was_solved(void**) {
  ProblemResult solved, near, touched;
  solved.clearance_m = near.clearance_m = 0.004;
  solved.self_clearance_m = near.self_clearance_m = touched.self_clearance_m = 0.02;
  solved.arrival_s = near.arrival_s = 1.5;
  near.error_m = 0.007;
  touched.clearance_m = -0.001;
  solved.kind = near.kind = "box";
  touched.kind = "cage";
  const std::string table = problem_table({solved, near, touched});
  const auto has_line = [&](const std::string& kind, const std::string& counts) {
    const size_t at = table.find("\n" + kind);
    std::string line = table.substr(at + 1, table.find('\n', at + 1) - at - 1), packed;
    for (const char c : line)
      if (c != ' ' || (!packed.empty() && packed.back() != ' ')) packed += c;
    check(packed == kind + counts, "'%s'", packed.c_str());
  };
  has_line("box", " 2 2 1 0 4.0 - 1.50");
  has_line("cage", " 1 0 0 1 -1.0 - -");
  has_line("all", " 3 2 1 1 -1.0 - 1.50");
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(the_arm_reaches_under_a_table),
      cmocka_unit_test(a_ball_that_crosses_the_way_is_evaded),
      cmocka_unit_test(contact_with_the_ball_is_seen),
      cmocka_unit_test(the_table_counts_what_was_solved),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
