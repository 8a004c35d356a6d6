#include <vector>

#include "firmware/model/clearance.h"
#include "firmware/model/nearest_points.h"
#include "tests/support/check.h"
#include "tests/support/closed_loop.h"
#include "tests/support/lwa3.h"

using namespace sidestep;
using test::ClosedLoop;

namespace {

struct Scenario {
  const char* name;
  Vector3 target_m, target_mps;
  bool has_obstacles;
  double duration_s;
  double error_at_s;  ///< time at which the error in the table of docs/paper.md was taken
};

const Scenario kA{"A", {0, 0.15, 1.0}, {0, 0.2, 0}, false, 2.3, 2.28};
const Scenario kB{"B", {0.4, 0.4, 0.8}, {0, 0, 0}, true, 8.0, 7.99};
const Scenario kC{"C", {0.1, 0.4, 0.8}, {0.2, 0, 0}, true, 2.8, 2.79};

struct Figures {
  double error_m = 0.0;            ///< tool to target at error_at_s
  double least_axis_m = HUGE_VAL;  ///< least distance from an obstacle's centre to the axis of a moving link
  double fastest_radps = 0.0;
};

double least_axis_distance_m(const ClosedLoop& loop) {
  const LinkPoses poses = forward_kinematics(loop.model.arm, loop.arm.position_rad);
  const Vector3 joints[] = {poses.origin[1], poses.origin[3], poses.origin[5], poses.tool_position};
  double least_m = HUGE_VAL;
  for (int o = 0; o < loop.obstacles->count; ++o) {
    const Vector3& centre = loop.obstacles->obstacles[static_cast<size_t>(o)].capsule.start;
    for (int i = 0; i < 3; ++i)
      least_m = std::min(least_m, (centre - nearest_on_segment(joints[i], joints[i + 1], centre)).norm());
  }
  return least_m;
}

/// Runs a simulation of the paper; its t = 0 is the first cycle that tracks.
Figures simulate(const Scenario& scenario, const PaperGains& gains) {
  Model model = test::lwa3_model("paper");
  model.settings.paper = gains;
  ClosedLoop loop(model, test::home_rad());
  check(loop.run_until(Mode::kHold, 1.0), "%s", loop.last.report.message);
  loop.target.position_m = scenario.target_m;
  loop.target.velocity_mps = scenario.target_mps;
  loop.sends_target = true;
  if (scenario.has_obstacles) {
    loop.add_sphere(Vector3(0.3, 0.2, 0.8), Vector3(0.2, 0, 0));
    loop.add_sphere(Vector3(0.1, 0.1, 0.8), Vector3(0, 0.2, 0));
    loop.add_sphere(Vector3(-0.1, 0.1, 0.8), Vector3(0, 0, 0.2));
  }
  Figures figures;
  for (int cycle = 0; cycle < std::lround(scenario.duration_s * 100); ++cycle) {
    figures.least_axis_m = std::min(figures.least_axis_m, least_axis_distance_m(loop));
    loop.cycle();
    check(loop.mode() == Mode::kTrack, "cycle %d: %s", cycle, loop.last.report.message);
    if (cycle == std::lround(scenario.error_at_s * 100)) figures.error_m = loop.last.report.target_distance_m;
    figures.fastest_radps = std::max(figures.fastest_radps, loop.arm.velocity_radps.cwiseAbs().maxCoeff());
  }
  check(loop.commands.violation().empty(), "%s: %s", scenario.name, loop.commands.violation().c_str());
  return figures;
}

PaperGains gains_of(double k_pos, double k_vel, ToolVelocity tool_velocity) {
  PaperGains gains;
  gains.k_pos_per_s2 = k_pos;
  gains.k_vel_per_s = k_vel;
  gains.tool_velocity = tool_velocity;
  return gains;
}

struct Expected {
  const Scenario* scenario;
  double error_mm, least_axis_m, fastest_radps;  ///< least_axis_m 0: no obstacles
};

/// Checks one row of the table in docs/paper.md, "Force to velocity": errors within 1 % or 0.01 mm, distances to the
/// last printed digit.
void check_row(const char* reading, const PaperGains& gains, const std::vector<Expected>& row) {
  for (const Expected& expected : row) {
    const Figures figures = simulate(*expected.scenario, gains);
    const char* name = expected.scenario->name;
    print_message("%s, %s: error %.2f mm, least distance %.4f m, fastest joint %.2f rad/s\n", reading, name,
                  figures.error_m * 1e3, figures.least_axis_m, figures.fastest_radps);
    check_near_because(figures.error_m * 1e3, expected.error_mm, std::max(0.01, 0.01 * expected.error_mm), "%s, %s",
                       reading, name);
    if (expected.least_axis_m > 0)
      check_near_because(figures.least_axis_m, expected.least_axis_m, 1e-4, "%s, %s", reading, name);
    check_near_because(figures.fastest_radps, expected.fastest_radps, 0.01, "%s, %s", reading, name);
  }
}

void results_with_measured_velocity_match_the_table(void**) {
  check_row("measured", gains_of(20, 8.94, ToolVelocity::kMeasured),
            {{&kA, 12.09, 0, 1.22}, {&kB, 0.0, 0.1394, 1.21}, {&kC, 65.59, 0.1467, 2.00}});
}

void results_with_softer_gains_match_the_table(void**) {
  check_row("k_pos 10", gains_of(10, 6.32, ToolVelocity::kMeasured),
            {{&kA, 23.53, 0, 1.21}, {&kB, 0.0, 0.1599, 1.08}, {&kC, 125.46, 0.1656, 2.00}});
}

void results_with_planned_velocity_match_the_table(void**) {
  check_row("planned", gains_of(20, 8.94, ToolVelocity::kPlanned),
            {{&kA, 0.75, 0, 1.61}, {&kB, 0.0, 0.0980, 1.85}, {&kC, 5.14, 0.1030, 2.00}});
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(results_with_measured_velocity_match_the_table),
      cmocka_unit_test(results_with_softer_gains_match_the_table),
      cmocka_unit_test(results_with_planned_velocity_match_the_table),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
