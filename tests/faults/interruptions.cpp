#include <csignal>

#include "firmware/base/realtime.h"
#include "tests/support/check.h"
#include "tests/support/live_scene.h"
#include "tests/support/lwa3.h"

using namespace sidestep;
using test::check_stream;
using test::LiveArm;
using test::LiveScene;
using test::Process;
using test::start_controller;

namespace {

using Status = controller_status_t;

bool any(const LiveArm& arm, size_t first, const std::function<bool(const Status&)>& is) {
  for (size_t i = first; i < arm.peer.statuses.size(); ++i)
    if (is(arm.peer.statuses[i])) return true;
  return false;
}

/// Missed cycles are counted and skipped: the controller sends no burst of commands, and brakes before it tracks again.
void a_controller_stopped_and_continued_brakes_and_tracks_again(void**) {
  LiveScene scene("sidestep");
  scene.controller.signal(SIGSTOP);
  scene.arm.run(0.5);
  const int64_t skipped = scene.arm.status().skipped_cycles;
  const size_t first = scene.arm.peer.statuses.size(), commands = scene.arm.peer.commands.size();
  const double continued_s = monotonic_s();
  scene.controller.signal(SIGCONT);
  scene.arm.run(0.1);
  const double passed_s = monotonic_s() - continued_s;  // on a busy machine more than 0.1 s
  const size_t soon = scene.arm.peer.commands.size() - commands;
  check(static_cast<double>(soon) <= 100.0 * passed_s + 4.0, "%zu commands in %g s", soon, passed_s);
  assert_true(
      any(scene.arm, first, [](const Status& s) { return s.mode == Status::BRAKE || s.mode == Status::FAULT; }));
  assert_true(scene.arm.status().skipped_cycles - skipped > 40);
  assert_true(scene.arm.run_until(Status::TRACK, 2.0));
  scene.wander(0.8);
  check_stream(scene.arm);
}

/// The simulator or driver ends and restarts with the arm in another configuration.
void an_arm_that_returns_elsewhere_is_moved_from_its_measured_position(void**) {
  LiveScene scene("sidestep");
  scene.arm.sends_target = scene.arm.sends_obstacles = scene.arm.sends_arm_state = false;
  scene.arm.run(0.4);
  assert_true(scene.arm.status().mode == Status::FAULT);
  check_stream(scene.arm);
  JointVector elsewhere_rad = test::home_rad();
  elsewhere_rad[0] -= 1.0;
  elsewhere_rad[3] += 0.7;
  LiveArm arm(test::lwa3().limits, elsewhere_rad);
  arm.target_m = scene.arm.target_m;
  arm.run(0.4);
  assert_int_equal(arm.peer.commands.size(), 0);  // half a second of consistent states first
  assert_true(arm.run_until(Status::TRACK, 2.0));
  arm.run(1.0);
  check_stream(arm);
}

/// The arm's side freezes, as by SIGSTOP and SIGCONT, then executes the commands received meanwhile.
void a_pause_of_the_arm_is_a_fault_and_tracking_resumes(void**) {
  LiveScene scene("sidestep");
  for (int i = 0; i < 3; ++i) {
    const size_t first = scene.arm.peer.statuses.size();
    scene.arm.peer.listen(0.3);
    assert_true(any(scene.arm, first, [](const Status& s) { return s.mode == Status::FAULT; }));
    scene.arm.run(0.05);
    assert_true(scene.arm.run_until(Status::TRACK, 2.0));
    scene.wander(0.4);
  }
  check_stream(scene.arm);
}

void a_second_controller_waits_until_the_first_is_gone(void**) {
  LiveScene scene("sidestep");
  Process second = start_controller("sidestep");
  const size_t first = scene.arm.peer.statuses.size();
  scene.wander(1.6);
  const auto reported_in = [&](int8_t mode) {
    return any(scene.arm, first, [mode](const Status& s) {
      return s.mode == mode && s.message.find("another controller") != std::string::npos;
    });
  };
  assert_true(reported_in(Status::WAIT));
  assert_false(reported_in(Status::BRAKE));
  scene.arm.sends_target = false;
  scene.arm.run(0.8);  // until the arm rests
  scene.controller.signal(SIGKILL);
  assert_int_equal(scene.controller.wait(1.0), 128 + SIGKILL);
  LiveArm arm(test::lwa3().limits,
              Eigen::Map<const Eigen::VectorXd>(scene.arm.peer.commands.back().joint_position.data(), 7));
  arm.target_m = Vector3(0.1, 0.45, 0.7);
  assert_true(arm.run_until(Status::TRACK, 3.0));
  arm.run(0.5);
  check_stream(arm);
}

/// Foreign commands cannot be prevented, so the controller stops its own motion.
void foreign_commands_brake(void**) {
  LiveScene scene("sidestep");
  joint_command_t foreign = scene.arm.peer.commands.back();
  foreign.utime += 123456789;
  foreign.seq += 1000000;
  test::LcmPeer foreign_controller;
  foreign_controller.send("ARM_COMMAND", foreign);
  foreign_controller.listen(0.3);
  bool braked = false;
  for (const Status& status : foreign_controller.statuses)
    braked |= status.message.find("another controller") != std::string::npos;
  assert_true(braked);
}

void without_permission_for_real_time_the_controller_runs_and_reports_it(void**) {
  Process controller =
      start_controller("sidestep", {"/usr/bin/setpriv", "--bounding-set=-sys_nice,-ipc_lock,-sys_resource",
                                    "/usr/bin/prlimit", "--rtprio=0:0", "--memlock=65536:65536"});
  LiveArm arm(test::lwa3().limits, test::home_rad());
  arm.target_m = Vector3(0.1, 0.45, 0.7);
  check(arm.run_until(Status::TRACK, 10.0), "%s", controller.output().c_str());
  arm.run(0.3);
  check(arm.status().limiting & Status::LIMITING_NOT_REALTIME, "limiting 0x%x", arm.status().limiting);
  check(controller.output().find("is not permitted") != std::string::npos, "%s", controller.output().c_str());
  check_stream(arm);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test_teardown(a_controller_stopped_and_continued_brakes_and_tracks_again, test::kill_processes),
      cmocka_unit_test_teardown(an_arm_that_returns_elsewhere_is_moved_from_its_measured_position,
                                test::kill_processes),
      cmocka_unit_test_teardown(a_pause_of_the_arm_is_a_fault_and_tracking_resumes, test::kill_processes),
      cmocka_unit_test_teardown(a_second_controller_waits_until_the_first_is_gone, test::kill_processes),
      cmocka_unit_test_teardown(foreign_commands_brake, test::kill_processes),
      cmocka_unit_test_teardown(without_permission_for_real_time_the_controller_runs_and_reports_it,
                                test::kill_processes),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
