#include <csignal>

#include "firmware/io/config/config.h"
#include "tests/support/check.h"
#include "tests/support/iiwa_driver.h"
#include "tests/support/process.h"

using namespace sidestep;
using test::IiwaDriver;
using test::private_lcm_url;
using test::Process;

namespace {

const char kConfig[] = "firmware/config/iiwa14-drake.yaml";

Process start_controller() {
  return Process({"build/controller", "--config", kConfig, "--lcm-url", private_lcm_url()});
}

JointVector home_rad() {
  JointVector q_rad = JointVector::Zero(7);
  q_rad << 0, 0.6, 0, -1.2, 0, 0.9, 0;
  return q_rad;
}

IiwaDriver start_driver() {
  return IiwaDriver(load_config(kConfig, {}).model.arm.limits, home_rad(), Vector3(0.5, 0.25, 0.6));
}

void check_driver(const IiwaDriver& driver) {
  check(driver.stop_reason.empty(), "the driver stopped: %s", driver.stop_reason.c_str());
  check(driver.commands.violation().empty(), "%s", driver.commands.violation().c_str());
}

/// Runs until the controller tracks and the arm moves.
void start_moving(IiwaDriver& driver, const Process& controller) {
  check(driver.run_until(controller_status_t::TRACK, 10.0), "%s", controller.output().c_str());
  for (int i = 0; i < 100 && driver.speed_radps() < 0.3; ++i) driver.run(0.02);
  check(driver.speed_radps() >= 0.3, "%g rad/s", driver.speed_radps());
}

void an_iiwa_moves_from_its_held_position_to_the_target(void**) {
  Process controller = start_controller();
  IiwaDriver driver = start_driver();
  assert_true(
      driver.peer.await([&] { return !driver.peer.statuses.empty(); }, 10.0));  // the controller waits for the driver
  start_moving(driver, controller);
  driver.run(3.0);
  check_driver(driver);
  check(driver.commands.fed() > 250, "%ld commands", driver.commands.fed());
  const controller_status_t& status = driver.peer.statuses.back();
  check(status.target_distance < 0.02, "%g m from the target", status.target_distance);
  assert_int_equal(status.rejected_messages, 0);
}

/// The driver is absent for long, then returns while the controller is still braking.
void a_restarted_driver_receives_no_command_within_its_guard_time(void**) {
  Process controller = start_controller();
  IiwaDriver driver = start_driver();
  for (const double silence_s : {1.0, 0.3}) {
    start_moving(driver, controller);
    driver.restart(silence_s);
    driver.run(0.3);
    check_driver(driver);
    driver.target_m.y() = -driver.target_m.y();
  }
  start_moving(driver, controller);
  check_driver(driver);
}

void a_restarted_controller_continues_from_the_position_that_the_driver_holds(void**) {
  IiwaDriver driver = start_driver();
  {
    Process killed = start_controller();
    start_moving(driver, killed);
    killed.signal(SIGKILL);
    killed.wait(1.0);
  }
  driver.run(0.2);
  const JointVector held_rad = driver.held_rad();
  driver.run(0.2);
  check_near(driver.held_rad(), held_rad, 0);
  driver.peer.statuses.clear();
  Process controller = start_controller();
  start_moving(driver, controller);
  check_driver(driver);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test_teardown(an_iiwa_moves_from_its_held_position_to_the_target, test::kill_processes),
      cmocka_unit_test_teardown(a_restarted_driver_receives_no_command_within_its_guard_time, test::kill_processes),
      cmocka_unit_test_teardown(a_restarted_controller_continues_from_the_position_that_the_driver_holds,
                                test::kill_processes),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
