// The arm among its own links: it says so when they limit it.
#include "tests/support/check.h"
#include "tests/support/closed_loop.h"

using namespace sidestep;
using test::ClosedLoop;

namespace {

void a_target_inside_the_arm_is_limited_by_links_that_are_named(void**) {
  ClosedLoop loop = test::tracking("sidestep");
  loop.obstacles->count = 0;
  loop.cycle();
  assert_int_equal(loop.last.report.limiting & kLimitingSelf, 0);
  loop.target.position_m = Vector3(0.05, 0, 0.25);  // in the arm's column
  int limited = 0;
  double least_m = 1.0;
  for (int cycle = 0; cycle < 600; ++cycle) {
    loop.cycle();
    const Report& report = loop.last.report;
    limited += (report.limiting & kLimitingSelf) != 0;
    least_m = std::min(least_m, report.nearest_links.distance_m);
    assert_true(report.nearest_links.first >= 0 && report.nearest_links.second >= 0);
  }
  print_message("limited in %d of 600 cycles, least distance of two links %.1f mm\n", limited, 1e3 * least_m);
  check(limited > 100, "only %d", limited);
  check(least_m > 0.019 && least_m < 0.03, "%g m", least_m);
  const NearestLinks& links = loop.last.report.nearest_links;
  const auto name = [&](int shape) { return loop.model.arm.shapes[static_cast<size_t>(shape)].link; };
  assert_true(name(links.first) != name(links.second));
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_target_inside_the_arm_is_limited_by_links_that_are_named),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
