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
using test::agreed;
using test::LiveArm;
using test::one_line_with;
using test::Process;
using test::Replay;
using test::replay;

namespace {

namespace fs = std::filesystem;
using Status = controller_status_t;

/// The LWA3's configuration with an empty folder for logs.
std::string config_with(const std::string& folder) {
  fs::remove_all(folder);
  const std::string text =
      test::replaced(test::text_of("firmware/config/lwa3.yaml"), "folder: build/blackbox", "folder: " + folder);
  return test::scratch_file("blackbox.yaml", text);
}

std::string log_folder() {
  return test::scratch_folder() + "/logs";
}

std::vector<std::string> logs() {
  std::vector<std::string> files;
  if (fs::exists(log_folder()))
    for (const auto& entry : fs::directory_iterator(log_folder())) files.push_back(entry.path().string());
  std::sort(files.begin(), files.end());
  return files;
}

/// A controller in real time that follows a target to and fro.
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
    run(1.0);
  }

  void run(double duration_s) {
    for (int i = 0; i * 0.25 < duration_s; ++i) {
      arm.target_m = i % 2 ? Vector3(0.1, 0.45, 0.7) : Vector3(-0.4, 0.1, 0.9);
      arm.run(0.25);
    }
  }

  /// Waits until so many logs are there and complete, and returns the newest.
  std::string await_log(size_t count) {
    const auto complete = [] {
      const std::vector<std::string> files = logs();
      return std::count_if(files.begin(), files.end(),
                           [](const auto& file) { return fs::path(file).extension() == ".lcmlog"; });
    };
    for (int i = 0; i < 100 && complete() < static_cast<long>(count); ++i) arm.run(0.05);
    check(complete() == static_cast<long>(count), "%ld logs: %s", complete(), controller.output().c_str());
    return logs().back();
  }
};

std::string last_line(const std::string& text) {
  const std::string whole = text.substr(0, text.find_last_not_of('\n') + 1);
  return whole.substr(whole.rfind('\n') + 1);
}

void a_fault_leaves_a_log_that_replays_bit_for_bit(void**) {
  for (const char* law : {"paper", "sidestep"}) {
    Scene scene(law);
    scene.arm.arm_speaks = false;
    assert_true(scene.arm.run_until(Status::FAULT, 2.0));
    const std::string log = scene.await_log(1);
    assert_true(log.find("-fault.lcmlog") != std::string::npos);
    assert_true(agreed(log) > 100);
    assert_true(!(scene.arm.status().limiting & Status::LIMITING_NO_BLACKBOX));
  }
}

/// Soon after one log another fault waits for company, but not beyond the end.
void a_fault_just_before_the_end_has_its_log(void**) {
  Scene scene;
  for (int fault = 0; fault < 2; ++fault) {
    scene.arm.arm_speaks = false;
    assert_true(scene.arm.run_until(Status::FAULT, 2.0));
    scene.await_log(1);
    scene.arm.arm_speaks = true;
    assert_true(scene.arm.run_until(Status::TRACK, 3.0));
  }
  scene.controller.signal(SIGTERM);
  scene.arm.run(0.5);
  assert_int_equal(scene.controller.wait(2.0), 0);
  assert_int_equal(logs().size(), 2);
  for (const std::string& log : logs()) assert_true(agreed(log) > 100);
}

void a_signal_asks_for_a_log_and_the_arm_moves_on(void**) {
  Scene scene;
  for (size_t count : {1, 2}) {
    scene.controller.signal(SIGUSR1);
    scene.await_log(count);
  }
  assert_int_equal(scene.arm.status().mode, Status::TRACK);
  scene.controller.signal(SIGUSR1);
  scene.controller.signal(SIGTERM);
  scene.arm.run(0.5);
  assert_int_equal(scene.controller.wait(2.0), 0);
  assert_int_equal(logs().size(), 3);
  for (const std::string& log : logs()) {
    assert_true(log.find("-request.lcmlog") != std::string::npos);
    assert_true(agreed(log) > 100);
  }
}

void another_configuration_is_found_out(void**) {
  Scene scene;
  scene.controller.signal(SIGUSR1);
  const std::string log = scene.await_log(1);
  const std::string slower = test::scratch_file(
      "slower.yaml", test::replaced(test::text_of(scene.config), "velocity_radps: [2.0", "velocity_radps: [0.2"));
  const Replay said = replay(log, {"--config", slower});
  check(said.code == 1 && one_line_with(last_line(said.output), {" differ, the first in cycle "}), "code %d: %s",
        said.code, said.output.c_str());
}

/// Cut off anywhere, or with one bit wrong: never a crash, one line (behind LCM's own, should it have one), and no cut
/// is taken for a whole log.
void a_damaged_log_is_one_clear_line(void**) {
  Scene scene;
  scene.controller.signal(SIGUSR1);
  const std::string text = test::text_of(scene.await_log(1));
  test::Random random(1);
  for (int i = 0; i < 60; ++i) {
    const auto at = static_cast<size_t>(random.uniform(0, i % 3 == 0 ? 400.0 : static_cast<double>(text.size())));
    std::string damaged = text;
    if (i % 2)
      damaged.resize(at);
    else
      damaged[at] = static_cast<char>(damaged[at] ^ (1 << random.index(8)));
    const Replay said = replay(test::scratch_file("damaged.lcmlog", damaged));
    check(said.code >= 0 && said.code <= 2, "byte %zu of %zu: code %d: %s", at, text.size(), said.code,
          said.output.c_str());
    check(i % 2 == 0 || said.code == 2, "cut at %zu of %zu: %s", at, text.size(), said.output.c_str());
    const std::string line = last_line(said.output);
    check(said.code != 2 || one_line_with(line, {"replay: "}), "byte %zu: '%s'", at, line.c_str());
  }
}

void files_that_are_no_logs_are_one_clear_line(void**) {
  for (const std::string& file :
       {std::string("no/such.lcmlog"), test::scratch_file("empty.lcmlog", ""), std::string("firmware/config/lwa3.yaml"),
        std::string("build"), std::string("/dev/null")}) {
    const Replay said = replay(file);
    const std::string line = last_line(said.output);
    check(said.code == 2 && one_line_with(line, {"replay: ", file}), "%s: code %d: '%s'", file.c_str(), said.code,
          line.c_str());
  }
}

void check_undisturbed(Scene& scene) {
  scene.controller.signal(SIGUSR1);
  scene.run(1.0);
  const Status& status = scene.arm.status();
  check(status.limiting & Status::LIMITING_NO_BLACKBOX, "limiting %d: %s", status.limiting,
        scene.controller.output().c_str());
  assert_true(scene.arm.run_until(Status::TRACK, 1.0));
  check(scene.arm.commands.complaint().empty(), "%s", scene.arm.commands.complaint().c_str());
  check(scene.controller.output().find("blackbox: ") != std::string::npos, "%s", scene.controller.output().c_str());
}

/// Files end after 64 blocks, as they do on a disk that fills up.
void a_full_disk_raises_a_flag_and_disturbs_nothing_else(void**) {
  Scene scene("sidestep", "trap '' XFSZ; ulimit -f 64; ");
  check_undisturbed(scene);
  check(logs().empty(), "%s was left behind", logs().front().c_str());
}

void a_folder_that_cannot_be_made_raises_the_flag_until_it_can(void**) {
  Scene scene;
  test::scratch_file("logs", "in the way");
  check_undisturbed(scene);
  fs::remove(log_folder());
  scene.controller.signal(SIGUSR1);
  const std::string log = scene.await_log(1);
  scene.arm.run(0.1);
  assert_true(!(scene.arm.status().limiting & Status::LIMITING_NO_BLACKBOX));
  agreed(log);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test_teardown(a_fault_leaves_a_log_that_replays_bit_for_bit, test::kill_processes),
      cmocka_unit_test_teardown(a_fault_just_before_the_end_has_its_log, test::kill_processes),
      cmocka_unit_test_teardown(a_signal_asks_for_a_log_and_the_arm_moves_on, test::kill_processes),
      cmocka_unit_test_teardown(another_configuration_is_found_out, test::kill_processes),
      cmocka_unit_test_teardown(a_damaged_log_is_one_clear_line, test::kill_processes),
      cmocka_unit_test_teardown(files_that_are_no_logs_are_one_clear_line, test::kill_processes),
      cmocka_unit_test_teardown(a_full_disk_raises_a_flag_and_disturbs_nothing_else, test::kill_processes),
      cmocka_unit_test_teardown(a_folder_that_cannot_be_made_raises_the_flag_until_it_can, test::kill_processes),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
