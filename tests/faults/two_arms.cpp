#include <algorithm>
#include <functional>
#include <sstream>

#include "tests/support/check.h"
#include "tests/support/lcm_peer.h"
#include "tests/support/live_scene.h"
#include "tests/support/lwa3.h"
#include "tests/support/process.h"
#include "tests/support/scratch.h"

using namespace sidestep;
using test::private_lcm_url;
using test::Process;
using test::replaced;

namespace {

constexpr char kScenario[] = "host/scenarios/two-arms.yaml";

std::string config_of(const std::string& arm) {
  return "firmware/config/" + arm + ".yaml";
}

struct Played {
  int code;  ///< of the simulator
  std::string text;
};

/// Two controllers in lockstep with a simulator of both arms, which measures their distance with FCL. csv: file of the
/// simulator.
Played play(const std::string& scenario, const std::string& left, const std::string& right, const std::string& csv) {
  const auto controller = [](const std::string& config) {
    return std::vector<std::string>{"build/controller", "--config",  config,
                                    "--lockstep",       "--lcm-url", private_lcm_url()};
  };
  const Process first(controller(left)), second(controller(right));
  Process sim({"build/sim", "--scenario", scenario, "--lockstep", "--csv", csv, "--lcm-url", private_lcm_url()});
  const int code = sim.wait(100.0);
  return {code, sim.output() + first.output() + second.output()};
}

/// A column of a CSV file, sorted.
std::vector<double> sorted_column(const std::string& file, const std::string& name) {
  std::istringstream lines(test::text_of(file));
  std::vector<double> values;
  size_t column = 0;
  for (std::string line; std::getline(lines, line);) {
    std::vector<std::string> cells;
    std::istringstream stream(line);
    for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
    if (column > 0) values.push_back(std::stod(cells.at(column)));
    if (column == 0) column = static_cast<size_t>(std::find(cells.begin(), cells.end(), name) - cells.begin());
  }
  std::sort(values.begin(), values.end());
  return values;
}

/// The scenario expects no contact, joints within their limits, and both tools at their targets at the end.
void two_controllers_share_a_workspace_without_contact(void**) {
  const std::string folder = test::scratch_folder();
  const Played played = play(kScenario, config_of("left"), config_of("right"), folder + "/run.csv");
  check(played.code == 0, "%s", played.text.c_str());
  for (const char* arm : {"left", "right"}) {
    const std::string file = folder + "/run-" + arm + ".csv";
    const auto errors_m = sorted_column(file, "target_distance_m"),
               gaps_m = sorted_column(file, "neighbour_clearance_m");
    print_message("%s: %.1f mm from the other arm at the least, %.1f mm from the target half of the time\n", arm,
                  1e3 * gaps_m.front(), 1e3 * errors_m[errors_m.size() / 2]);
    check(gaps_m.front() > 0.0 && gaps_m.front() < 0.1, "%g m", gaps_m.front());
    check(errors_m[errors_m.size() / 2] < 0.05, "%g m", errors_m[errors_m.size() / 2]);
  }
}

std::string without_neighbour(const std::string& arm, const std::string& other) {
  return test::scratch_file(arm + ".yaml",
                            replaced(test::text_of(config_of(arm)), "listen: [" + other + "]", "listen: []"));
}

/// Proves that the arms of this scenario must avoid each other.
void arms_that_do_not_receive_each_others_links_collide(void**) {
  const std::string left = without_neighbour("left", "RIGHT_LINKS"), right = without_neighbour("right", "LEFT_LINKS");
  const std::string text = replaced(test::text_of(kScenario), "duration_s: 20", "duration_s: 5");
  const Played played =
      play(test::scratch_file("separate.yaml", text), left, right, test::scratch_folder() + "/separate.csv");
  check(played.code == 1 && played.text.find("contact                   YES") != std::string::npos, "%s",
        played.text.c_str());
}

/// In real time; the neighbour is one sphere far away.
void a_neighbour_that_sends_no_links_stops_the_arm(void**) {
  const std::string config = test::scratch_file(
      "arm.yaml", replaced(test::text_of("firmware/config/lwa3.yaml"), "listen: []", "listen: [LINKS_R]"));
  Process controller({"build/controller", "--config", config, "--lcm-url", private_lcm_url()});
  test::LiveArm arm(test::lwa3().limits, test::home_rad());
  arm.target_m = Vector3(0.1, 0.45, 0.7);
  int64_t links_utime = 0;
  /// Until the condition holds, for at most limit_s. Returns whether it does.
  const auto run_until = [&](const std::function<bool()>& holds, bool neighbour_sends, double limit_s) {
    for (double t_s = 0.0; t_s < limit_s && !holds(); t_s += 0.02) {
      const obstacle_t ball = test::sphere(0, Vector3(3, 3, 3), 0.1, Vector3::Zero());
      if (neighbour_sends) arm.peer.send("LINKS_R", test::obstacles_message(++links_utime, {ball}));
      arm.run(0.02);
    }
    return holds();
  };
  arm.peer.await([&] { return !arm.peer.statuses.empty(); }, 10.0);
  const auto waits = [&] { return arm.status().mode == controller_status_t::WAIT; };
  const auto tracks = [&] { return arm.status().mode == controller_status_t::TRACK; };
  const auto brakes = [&] { return arm.status().mode == controller_status_t::BRAKE; };
  check(!run_until([&] { return !waits(); }, false, 1.0), "%s", arm.status().message.c_str());
  check(run_until(tracks, true, 1.0), "%s", arm.status().message.c_str());
  check(run_until([&] { return arm.speed_radps() > 0.3; }, true, 1.0), "%g rad/s", arm.speed_radps());
  check(run_until(brakes, false, 0.2), "%s", arm.status().message.c_str());
  check(run_until([&] { return arm.speed_radps() == 0.0; }, false, 0.5), "%g rad/s", arm.speed_radps());
  check(run_until(tracks, true, 0.5), "%s", arm.status().message.c_str());
  test::check_stream(arm);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test_teardown(two_controllers_share_a_workspace_without_contact, test::kill_processes),
      cmocka_unit_test_teardown(a_neighbour_that_sends_no_links_stops_the_arm, test::kill_processes),
      cmocka_unit_test_teardown(arms_that_do_not_receive_each_others_links_collide, test::kill_processes),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
