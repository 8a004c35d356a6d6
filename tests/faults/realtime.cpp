#include <algorithm>
#include <csignal>

#include "tests/support/check.h"
#include "tests/support/live_scene.h"
#include "tests/support/lwa3.h"

using namespace sidestep;
using test::Bytes;
using test::check_stream;
using test::LiveArm;
using Scene = test::LiveScene;
using test::Process;
using test::start_controller;

namespace {

using Status = controller_status_t;
const char* const kLaws[] = {"paper", "sidestep"};

bool has_braked_because(const LiveArm& arm, const char* reason) {
  return std::any_of(arm.peer.statuses.begin(), arm.peer.statuses.end(), [&](const Status& status) {
    return status.mode == Status::BRAKE && status.message.find(reason) != std::string::npos;
  });
}

/// Skipped cycles are counted with the others, so that a busy machine does not change the rate.
void the_loop_holds_its_rate(void**) {
  for (const char* law : kLaws) {
    Scene scene(law);
    const Status first = scene.arm.status();
    const size_t seen = scene.arm.peer.statuses.size();
    scene.arm.run(2.0);
    const Status last = scene.arm.status();
    const double duration_s = static_cast<double>(last.utime - first.utime) * 1e-6;
    const auto cycles = static_cast<double>(last.seq - first.seq),
               skipped = static_cast<double>(last.skipped_cycles - first.skipped_cycles);
    const double rate_hz = (cycles + skipped) / duration_s;
    print_message("%s: %.1f Hz with %g skipped of %g\n", law, rate_hz, skipped, cycles + skipped);
    check(rate_hz > 98 && rate_hz < 102, "%g Hz", rate_hz);
    check(skipped < 0.5 * cycles, "%g of %g cycles were skipped", skipped, cycles + skipped);
    check_near(static_cast<double>(scene.arm.peer.statuses.size() - seen), cycles, 2.0);
    check(last.cycle_time > 0 && last.cycle_time < 0.01, "cycle time %g s", last.cycle_time);
  }
}

void no_command_is_sent_before_the_first_arm_state(void**) {
  LiveArm arm{test::lwa3().limits, test::home_rad()};
  arm.sends_arm_state = false;
  Process controller = start_controller("sidestep");
  assert_true(arm.run_until(Status::WAIT, 10.0));
  arm.run(1.0);
  assert_true(arm.status().mode == Status::WAIT && arm.reports("waiting for the first arm state"));
  assert_int_equal(arm.peer.commands.size(), 0);
  arm.sends_arm_state = true;
  assert_true(arm.run_until(Status::TRACK, 3.0));
}

void missing_arm_states_brake_and_then_are_a_fault(void**) {
  for (const char* law : kLaws) {
    Scene scene(law);
    scene.arm.sends_arm_state = false;
    scene.arm.run(1.0);
    assert_true(has_braked_because(scene.arm, "arm state is too old"));
    assert_true(scene.arm.status().mode == Status::FAULT && scene.arm.reports("no arm state"));
    assert_int_equal(scene.arm.status().fault, Status::FAULT_ARM_STATE_LOST);
    check_near(scene.arm.speed_radps(), 0.0, 0);
    scene.arm.sends_arm_state = true;
    assert_true(scene.arm.run_until(Status::TRACK, 3.0));
    check_stream(scene.arm);
  }
}

void old_obstacles_brake_and_an_old_target_leads_to_hold(void**) {
  Scene scene("sidestep");
  scene.arm.sends_obstacles = false;
  assert_true(scene.arm.run_until(Status::BRAKE, 1.0));
  scene.arm.run(0.5);
  assert_true(has_braked_because(scene.arm, "obstacles are too old"));
  check_near(scene.arm.speed_radps(), 0.0, 0);
  scene.arm.sends_obstacles = true;
  assert_true(scene.arm.run_until(Status::TRACK, 1.0));
  scene.arm.sends_target = false;
  assert_true(scene.arm.run_until(Status::HOLD, 1.0));
  assert_true(scene.arm.reports("target is too old"));
  check_stream(scene.arm);
}

void a_signal_brakes_to_rest_and_ends_with_code_0(void**) {
  for (const char* law : kLaws) {
    for (const int signal : {SIGTERM, SIGINT, SIGHUP}) {
      Scene scene(law);
      scene.controller.signal(signal);
      scene.arm.run(0.5);
      const int code = scene.controller.wait(1.5);
      check(code == 0, "signal %d: code %d, %s", signal, code, scene.controller.output().c_str());
      check_near(scene.arm.speed_radps(), 0.0, 0);
      check(scene.controller.output().find("cycles") != std::string::npos, "no summary: %s",
            scene.controller.output().c_str());
      scene.arm.commands.end();
      check_stream(scene.arm);
    }
  }
}

void the_arm_can_follow_every_command_of_a_live_run(void**) {
  for (const char* law : kLaws) {
    Scene scene(law);
    scene.wander(3.2);
    assert_true(scene.arm.peer.commands.size() > 150);
    check_stream(scene.arm);
  }
}

/// Thousands of bad messages a second on every channel are counted, and the arm keeps tracking.
void a_flood_of_hostile_messages_changes_nothing(void**) {
  Scene scene("sidestep");
  const int64_t rejected = scene.arm.status().rejected_messages;
  int64_t sent = 0;
  for (int i = 0; i < 100; ++i) {
    scene.arm.target_m = i % 60 < 30 ? Vector3(0.1, 0.45, 0.7) : Vector3(-0.4, 0.1, 0.9);
    for (int n = 0; n < 60; ++n, ++sent) {
      Bytes bytes = test::encoded(test::target_message(1, Vector3(0, 0, 0), Vector3(0, 0, 0)));
      if (n % 3 == 0) bytes[3] ^= 0x10;
      if (n % 3 == 1) bytes.resize(static_cast<size_t>(n));
      if (n % 3 == 2) bytes[16] = 0x7f, bytes[17] = 0xff;
      const char* const channels[] = {"ARM_STATE", "OBSTACLES", "TARGET"};
      scene.arm.peer.send_bytes(channels[n % 3], bytes);
    }
    scene.arm.run(0.01);
  }
  scene.arm.run(0.2);
  const int64_t counted = scene.arm.status().rejected_messages - rejected;
  int64_t tracking = 0;
  for (const Status& status : scene.arm.peer.statuses) tracking += status.mode == Status::TRACK;
  assert_true(scene.arm.run_until(Status::TRACK, 1.0));
  check(counted <= sent && counted > sent * 9 / 10, "%ld of %ld counted", counted, sent);
  check(tracking > 60, "tracking in %ld cycles", tracking);
  check(scene.arm.reports("rejected"), "%s", scene.arm.status().message.c_str());
  check_stream(scene.arm);
}

/// The controller is killed without braking and restarted while the arm is between start and target.
void a_killed_and_restarted_controller_continues_without_a_jump(void**) {
  Scene scene("sidestep");
  scene.controller.signal(SIGKILL);
  assert_int_equal(scene.controller.wait(1.0), 128 + SIGKILL);
  scene.arm.run(0.1);
  const JointVector rest_rad =
      Eigen::Map<const Eigen::VectorXd>(scene.arm.peer.commands.back().joint_position.data(), 7);
  LiveArm arm(test::lwa3().limits, rest_rad);
  arm.target_m = Vector3(0.1, 0.45, 0.7);
  Process again = start_controller("sidestep");
  assert_true(arm.run_until(Status::TRACK, 5.0));
  arm.run(1.0);
  check_stream(arm);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test_teardown(the_loop_holds_its_rate, test::kill_processes),
      cmocka_unit_test_teardown(no_command_is_sent_before_the_first_arm_state, test::kill_processes),
      cmocka_unit_test_teardown(missing_arm_states_brake_and_then_are_a_fault, test::kill_processes),
      cmocka_unit_test_teardown(old_obstacles_brake_and_an_old_target_leads_to_hold, test::kill_processes),
      cmocka_unit_test_teardown(a_signal_brakes_to_rest_and_ends_with_code_0, test::kill_processes),
      cmocka_unit_test_teardown(the_arm_can_follow_every_command_of_a_live_run, test::kill_processes),
      cmocka_unit_test_teardown(a_flood_of_hostile_messages_changes_nothing, test::kill_processes),
      cmocka_unit_test_teardown(a_killed_and_restarted_controller_continues_without_a_jump, test::kill_processes),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
