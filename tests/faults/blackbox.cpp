#include <csignal>
#include <filesystem>

#include "tests/support/check.h"
#include "tests/support/live_arm.h"
#include "tests/support/lwa3.h"
#include "tests/support/process.h"
#include "tests/support/random.h"
#include "tests/support/replay.h"
#include "tests/support/scratch.h"

using namespace sidestep;
using test::agreeing_cycles;
using test::LiveArm;
using test::one_line_with;
using test::Process;
using test::Replay;
using test::replay;

namespace {

namespace fs = std::filesystem;
using Status = controller_status_t;

/// The LWA3's configuration with an empty folder for logs of 4 s.
std::string config_with(const std::string& folder) {
  fs::remove_all(folder);
  const std::string text =
      test::replaced(test::text_of("firmware/config/lwa3.yaml"), "folder: build/blackbox", "folder: " + folder);
  return test::scratch_file("blackbox.yaml", test::replaced(text, "seconds: 10", "seconds: 4"));
}

std::string log_folder() {
  return test::scratch_folder() + "/logs";
}

std::vector<std::string> logs(const std::string& reason) {
  return test::logs_in(log_folder(), reason);
}

/// A controller in real time that tracks a target which alternates between two positions.
struct Scene {
  std::string config = config_with(log_folder());
  Process controller;
  LiveArm arm{test::lwa3().limits, test::home_rad()};

  explicit Scene(const std::string& law = "sidestep", const std::string& before = "")
      : controller({"/bin/sh", "-c",
                    before + "exec build/controller --config " + config + " --law " + law + " --lcm-url '" +
                        test::private_lcm_url() + "'"}) {
    arm.target_m = Vector3(0.1, 0.45, 0.7);
    check(arm.run_until(Status::TRACK, 10.0), "%s", controller.output().c_str());
    track();
  }

  /// Runs until the controller has tracked for 1.5 s without interruption, for at most 60 s: pauses of a busy machine
  /// interrupt it.
  void track() {
    int in_a_row = 0;
    for (int i = 0; in_a_row < 6; ++i) {
      check(i < 240, "%s", controller.output().c_str());
      arm.target_m = i % 2 ? Vector3(0.1, 0.45, 0.7) : Vector3(-0.4, 0.1, 0.9);
      const auto received = static_cast<std::ptrdiff_t>(arm.peer.statuses.size());
      arm.run(0.25);
      const bool all = std::all_of(arm.peer.statuses.begin() + received, arm.peer.statuses.end(),
                                   [](const Status& status) { return status.mode == Status::TRACK; });
      in_a_row = all ? in_a_row + 1 : 0;
    }
  }

  /// Runs until the condition holds, for at most limit_s.
  template <typename Condition>
  bool await(Condition condition, double limit_s = 1.0) {
    for (double t_s = 0.0; t_s < limit_s && !condition(); t_s += 0.05) arm.run(0.05);
    return condition();
  }

  /// Stops the arm states until the controller reports the fault.
  void stop_arm_states() {
    arm.sends_arm_state = false;
    assert_true(arm.run_until(Status::FAULT, 2.0));
  }

  /// Waits until there are more than `older` logs of this reason and returns the newest. The log of a fault may be
  /// delayed by the 4 s that pass after one caused by a pause of the machine.
  std::string await_log(const std::string& reason, size_t older) {
    check(await([&] { return logs(reason).size() > older; }, 9.0), "%zu logs: %s", logs(reason).size(),
          controller.output().c_str());
    return logs(reason).back();
  }

  std::string request_log() {
    const size_t older = logs("request").size();
    controller.signal(SIGUSR1);
    return await_log("request", older);
  }

  void end() {
    controller.signal(SIGTERM);
    arm.run(0.5);
    assert_int_equal(controller.wait(2.0), 0);
  }

  bool lacks_blackbox() const { return arm.status().limiting & Status::LIMITING_NO_BLACKBOX; }
};

std::string last_line(const std::string& text) {
  const std::string whole = text.substr(0, text.find_last_not_of('\n') + 1);
  return whole.substr(whole.rfind('\n') + 1);
}

void a_fault_leaves_a_log_that_replays_bit_for_bit(void**) {
  for (const char* law : {"paper", "sidestep"}) {
    Scene scene(law);
    const size_t older = logs("fault").size();
    scene.stop_arm_states();
    assert_true(agreeing_cycles(scene.await_log("fault", older)) > 100);
    assert_true(!scene.lacks_blackbox());
  }
}

/// The log of a fault soon after another one is delayed, but not beyond the end of the controller.
void a_fault_just_before_the_end_leaves_a_log(void**) {
  Scene scene;
  const size_t older = logs("fault").size();
  for (int fault = 0; fault < 2; ++fault) {
    scene.stop_arm_states();
    scene.await_log("fault", older);
    assert_int_equal(logs("fault").size(), older + 1);
    scene.arm.sends_arm_state = true;
    assert_true(scene.arm.run_until(Status::TRACK, 3.0));
  }
  scene.end();
  const std::vector<std::string> all = logs("fault");
  assert_int_equal(all.size(), older + 2);
  for (size_t i = older; i < all.size(); ++i) assert_true(agreeing_cycles(all[i]) > 100);
}

void a_signal_requests_a_log_and_the_arm_keeps_moving(void**) {
  Scene scene;
  for (int i = 0; i < 2; ++i) scene.request_log();
  scene.track();
  assert_true(scene.arm.commands.violation().empty());
  scene.controller.signal(SIGUSR1);
  scene.end();
  assert_int_equal(logs("request").size(), 3);
  for (const std::string& log : logs("request")) assert_true(agreeing_cycles(log) > 100);
}

void a_replay_with_another_configuration_is_reported_as_different(void**) {
  Scene scene;
  const std::string log = scene.request_log();
  const std::string slower = test::scratch_file(
      "slower.yaml", test::replaced(test::text_of(scene.config), "velocity_radps: [2.0", "velocity_radps: [0.2"));
  const Replay result = replay(log, {"--config", slower});
  check(result.code == 1 && one_line_with(last_line(result.output), {" differ, the first in cycle "}), "code %d: %s",
        result.code, result.output.c_str());
}

/// A log that is cut anywhere or has one wrong bit causes no crash and at most one line of error, behind any line of
/// LCM. A cut log is always refused.
void a_damaged_log_is_reported_in_one_line(void**) {
  Scene scene;
  const std::string text = test::text_of(scene.request_log());
  test::Random random(1);
  for (int i = 0; i < 60; ++i) {
    const auto at = static_cast<size_t>(random.uniform(0, i % 3 == 0 ? 400.0 : static_cast<double>(text.size())));
    std::string damaged = text;
    if (i % 2)
      damaged.resize(at);
    else
      damaged[at] = static_cast<char>(damaged[at] ^ (1 << random.index(8)));
    const Replay result = replay(test::scratch_file("damaged.lcmlog", damaged));
    check(result.code >= 0 && result.code <= 2, "byte %zu of %zu: code %d: %s", at, text.size(), result.code,
          result.output.c_str());
    check(i % 2 == 0 || result.code == 2, "cut at %zu of %zu: %s", at, text.size(), result.output.c_str());
    const std::string line = last_line(result.output);
    check(result.code != 2 || one_line_with(line, {"replay: "}), "byte %zu: '%s'", at, line.c_str());
  }
}

void files_that_are_no_logs_are_refused_in_one_line(void**) {
  for (const std::string& file :
       {std::string("no/such.lcmlog"), test::scratch_file("empty.lcmlog", ""), std::string("firmware/config/lwa3.yaml"),
        std::string("build"), std::string("/dev/null")}) {
    const Replay result = replay(file);
    const std::string line = last_line(result.output);
    check(result.code == 2 && one_line_with(line, {"replay: ", file}), "%s: code %d: '%s'", file.c_str(), result.code,
          line.c_str());
  }
}

void check_undisturbed(Scene& scene) {
  scene.controller.signal(SIGUSR1);
  check(scene.await([&] { return scene.lacks_blackbox(); }), "%s", scene.controller.output().c_str());
  scene.track();
  check(scene.arm.commands.violation().empty(), "%s", scene.arm.commands.violation().c_str());
  check(scene.controller.output().find("blackbox: ") != std::string::npos, "%s", scene.controller.output().c_str());
}

/// ulimit ends every file after 64 blocks, as a full disk would.
void a_full_disk_raises_a_flag_and_disturbs_nothing_else(void**) {
  Scene scene("sidestep", "trap '' XFSZ; ulimit -f 64; ");
  check_undisturbed(scene);
  assert_true(scene.await([] { return fs::is_empty(log_folder()); }));
}

void a_folder_that_cannot_be_created_raises_the_flag_until_it_can(void**) {
  Scene scene;
  fs::remove_all(log_folder());
  test::scratch_file("logs", "a file of this name");
  check_undisturbed(scene);
  fs::remove(log_folder());
  agreeing_cycles(scene.request_log());
  assert_true(scene.await([&] { return !scene.lacks_blackbox(); }));
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test_teardown(a_fault_leaves_a_log_that_replays_bit_for_bit, test::kill_processes),
      cmocka_unit_test_teardown(a_fault_just_before_the_end_leaves_a_log, test::kill_processes),
      cmocka_unit_test_teardown(a_signal_requests_a_log_and_the_arm_keeps_moving, test::kill_processes),
      cmocka_unit_test_teardown(a_replay_with_another_configuration_is_reported_as_different, test::kill_processes),
      cmocka_unit_test_teardown(a_damaged_log_is_reported_in_one_line, test::kill_processes),
      cmocka_unit_test_teardown(files_that_are_no_logs_are_refused_in_one_line, test::kill_processes),
      cmocka_unit_test_teardown(a_full_disk_raises_a_flag_and_disturbs_nothing_else, test::kill_processes),
      cmocka_unit_test_teardown(a_folder_that_cannot_be_created_raises_the_flag_until_it_can, test::kill_processes),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
