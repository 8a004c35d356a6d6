#include <chrono>
#include <csignal>
#include <map>
#include <sstream>
#include <thread>

#include "tests/support/check.h"
#include "tests/support/lcm_peer.h"
#include "tests/support/process.h"
#include "tests/support/scratch.h"

using namespace sidestep;
using test::private_lcm_url;
using test::Process;
using test::text_of;

namespace {

/// A CSV file by column. A field that is not a number counts as 0.
using Columns = std::map<std::string, std::vector<double>>;

Columns columns_of(const std::string& csv) {
  std::istringstream lines(csv);
  std::string line, field;
  std::vector<std::string> names;
  std::getline(lines, line);
  for (std::istringstream header(line); std::getline(header, field, ',');) names.push_back(field);
  Columns columns;
  while (std::getline(lines, line)) {
    std::istringstream row(line);
    for (const std::string& name : names)
      if (std::getline(row, field, ',')) columns[name].push_back(std::strtod(field.c_str(), nullptr));
  }
  return columns;
}

/// Plays a scenario with both programs and returns the simulator's CSV. met: whether its expectations must be met.
/// late_ms: how much later than the simulator the controller starts.
std::string play(const std::string& scenario, const std::string& law, bool lockstep, bool met = true, int late_ms = 0) {
  const std::string csv = test::scratch_folder() + "/" + scenario + ".csv";
  std::vector<std::string> controller = {
      "build/controller", "--config", "firmware/config/lwa3.yaml", "--law", law, "--lcm-url", private_lcm_url()};
  std::vector<std::string> sim = {
      "build/sim", "--scenario",     "host/scenarios/" + scenario + ".yaml", "--csv", csv, "--quiet",
      "--lcm-url", private_lcm_url()};
  if (lockstep) {
    controller.emplace_back("--lockstep");
    sim.emplace_back("--lockstep");
  }
  Process the_sim(sim);
  std::this_thread::sleep_for(std::chrono::milliseconds(late_ms));
  Process the_controller(controller);
  const int code = the_sim.wait(300.0);  // a build with sanitizers is slow
  check(code == (met ? 0 : 1), "%s, law %s: the simulator's code is %d: %s", scenario.c_str(), law.c_str(), code,
        the_sim.output().c_str());
  the_controller.signal(SIGTERM);
  check(the_controller.wait(5.0) == 0, "%s, law %s: %s", scenario.c_str(), law.c_str(),
        the_controller.output().c_str());
  return text_of(csv);
}

/// Both programs and their messages against one independent NumPy program.
void the_papers_simulations_agree_with_numpy_from_end_to_end(void**) {
  for (const char* scenario : {"paper-a", "paper-b", "paper-c"}) {
    Process numpy({"build/venv/bin/python", "tests/support/paper_law.py", "simulate", scenario});
    assert_int_equal(numpy.wait(60.0), 0);
    const Columns expected = columns_of(numpy.output()), actual = columns_of(play(scenario, "paper", true));
    assert_true(actual.size() > 25);
    double worst = 0.0;
    for (const auto& [name, values] : expected) {
      check(actual.count(name) == 1 && actual.at(name).size() == values.size(), "%s: column %s", scenario,
            name.c_str());
      if (name == "cycle_time_s") continue;
      for (size_t row = 0; row < values.size(); ++row) {
        check_near_because(actual.at(name)[row], values[row], 1e-9, "%s, %s, row %zu", scenario, name.c_str(), row);
        worst = std::max(worst, test::gap(actual.at(name)[row], values[row]));
      }
    }
    print_message("%s: %zu columns, %zu rows, largest difference %.1e\n", scenario, actual.size(),
                  actual.at("t_s").size(), worst);
  }
}

void two_lockstep_runs_are_equal(void**) {
  Columns one = columns_of(play("paper-c", "sidestep", true)), two = columns_of(play("paper-c", "sidestep", true));
  one.erase("cycle_time_s");
  two.erase("cycle_time_s");
  assert_true(one == two);
  assert_true(one.at("t_s").size() > 200);
}

/// The simulator repeats its messages until the controller answers: how often must not matter.
void a_lockstep_run_does_not_depend_on_when_the_controller_starts(void**) {
  Columns soon = columns_of(play("closing-gap", "sidestep", true)),
          late = columns_of(play("closing-gap", "sidestep", true, true, 450));
  soon.erase("cycle_time_s");
  late.erase("cycle_time_s");
  assert_true(soon == late);
}

void a_run_in_real_time_ends_like_one_in_lockstep(void**) {
  const Columns live = columns_of(play("paper-c", "sidestep", false)),
                lockstep = columns_of(play("paper-c", "sidestep", true));
  assert_true(live.at("t_s").size() > 200);
  for (const double clearance_m : live.at("clearance_m")) assert_true(clearance_m > 0);
  check_near(live.at("target_distance_m").back(), lockstep.at("target_distance_m").back(), 0.03);
}

/// In these scenarios a law that only reacts gets stuck or hits an obstacle.
void the_sidestep_law_arrives_where_the_papers_law_does_not(void**) {
  for (const char* scenario : {"parked-obstacle", "closing-gap", "pillar", "two-people", "moving-shelf"}) {
    play(scenario, "paper", true, false);
    play(scenario, "sidestep", true);
  }
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test_teardown(the_papers_simulations_agree_with_numpy_from_end_to_end, test::kill_processes),
      cmocka_unit_test_teardown(the_sidestep_law_arrives_where_the_papers_law_does_not, test::kill_processes),
      cmocka_unit_test_teardown(two_lockstep_runs_are_equal, test::kill_processes),
      cmocka_unit_test_teardown(a_lockstep_run_does_not_depend_on_when_the_controller_starts, test::kill_processes),
      cmocka_unit_test_teardown(a_run_in_real_time_ends_like_one_in_lockstep, test::kill_processes),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
