#include <cmath>
#include <csignal>

#include "firmware/io/config/config.h"

#include "tests/support/check.h"
#include "tests/support/iiwa_driver.h"
#include "tests/support/live_arm.h"
#include "tests/support/lwa3.h"
#include "tests/support/messages.h"
#include "tests/support/process.h"
#include "tests/support/replay.h"
#include "tests/support/scratch.h"

using namespace sidestep;
using test::agreeing_cycles;
using test::logs_in;
using test::Process;
using test::text_of;
using Status = controller_status_t;

namespace {

std::string log_folder(const std::string& name) {
  return test::scratch_folder() + "/" + name;
}

/// A configuration that writes its logs to a folder of that name.
std::string config_file(const std::string& name, const std::string& text) {
  return test::scratch_file(name + ".yaml",
                            test::replaced(text, "folder: build/blackbox", "folder: " + log_folder(name)));
}

std::vector<std::string> controller(const std::string& config) {
  return {"build/controller", "--config", config, "--lcm-url", test::private_lcm_url()};
}

/// Replays the requested log of a controller that has ended. Returns the number of cycles that agree.
int replay_request(const std::string& name) {
  const std::vector<std::string> logs = logs_in(log_folder(name), "request");
  assert_int_equal(logs.size(), 1);
  return agreeing_cycles(logs.front());
}

void a_log_of_an_iiwa_replays_bit_for_bit(void**) {
  const std::string config = config_file("iiwa", text_of("firmware/config/iiwa14-drake.yaml"));
  Process process(controller(config));
  JointVector home_rad = JointVector::Zero(7);
  home_rad << 0, 0.6, 0, -1.2, 0, 0.9, 0;
  test::IiwaDriver driver(load_config(config, {}).model.arm.limits, home_rad, Vector3(0.5, 0.25, 0.6));
  check(driver.run_until(Status::TRACK, 20.0), "%s", process.output().c_str());
  driver.run(1.5);
  process.signal(SIGUSR1);
  driver.run(0.5);
  process.signal(SIGTERM);
  driver.run(1.0);
  assert_int_equal(process.wait(5.0), 0);
  assert_true(replay_request("iiwa") > 100);
}

/// Runs while a neighbour sends a moving link, ten times as often as its timeout requires.
void run_with_neighbour(test::LiveArm& arm, double duration_s) {
  for (double t_s = 0.0; t_s < duration_s; t_s += 0.01) {
    static int64_t utime = 0;
    utime += 10000;
    const double y_m = 0.5 * std::sin(static_cast<double>(utime) * 1e-6);
    arm.peer.send("LINKS_2", test::obstacles_message(utime, {test::sphere(0, {-0.9, y_m, 0.8}, 0.1, Vector3::Zero())}));
    arm.run(0.01);
  }
}

void a_log_with_surroundings_and_a_neighbour_replays_bit_for_bit(void**) {
  std::string text = text_of("firmware/config/lwa3.yaml");
  text = test::replaced(text, "listen: []", "listen: [LINKS_2]");
  text = test::replaced(text, "surroundings: []",
                        "surroundings: [{shape: box, edges_m: [0.7, 1.2, 0.04], position_m: [-0.8, 0, 0.1]}]");
  Process process(controller(config_file("room", text)));
  test::LiveArm arm(test::lwa3().limits, test::home_rad());
  arm.target_m = Vector3(0.1, 0.45, 0.7);
  for (int i = 0; i < 100 && (arm.peer.statuses.empty() || arm.status().mode != Status::TRACK); ++i)
    run_with_neighbour(arm, 0.2);
  check(!arm.peer.statuses.empty() && arm.status().mode == Status::TRACK, "%s", process.output().c_str());
  arm.target_m = Vector3(-0.4, 0.1, 0.9);
  run_with_neighbour(arm, 1.5);
  process.signal(SIGUSR1);
  run_with_neighbour(arm, 0.5);
  process.signal(SIGTERM);
  run_with_neighbour(arm, 1.0);
  assert_int_equal(process.wait(5.0), 0);
  assert_true(replay_request("room") > 100);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test_teardown(a_log_of_an_iiwa_replays_bit_for_bit, test::kill_processes),
      cmocka_unit_test_teardown(a_log_with_surroundings_and_a_neighbour_replays_bit_for_bit, test::kill_processes),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
