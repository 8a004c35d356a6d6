#include <csignal>
#include <fstream>

#include "tests/support/check.h"
#include "tests/support/lcm_peer.h"
#include "tests/support/notify_socket.h"
#include "tests/support/process.h"
#include "tests/support/scratch.h"

using namespace sidestep;
using test::LcmPeer;
using test::one_line_with;
using test::private_lcm_url;
using test::Process;
using test::scratch_file;

namespace {

constexpr double kLimit_s = 10.0;

std::vector<std::string> controller(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "build/controller");
  arguments.insert(arguments.end(), {"--lcm-url", private_lcm_url()});
  return arguments;
}

/// The output without its line end.
std::string line_of(const std::string& output) {
  return output.substr(0, output.find_last_not_of('\n') + 1);
}

void a_bad_config_ends_with_code_2_and_one_line_and_publishes_nothing(void**) {
  const std::string robot = "robot: {urdf: urdf/lwa3.urdf, base: base_link, tip: tool}\n";
  const struct {
    std::string config;
    const char* word;
  } cases[] = {
      {"no/such/file.yaml", "no/such/file.yaml"},
      {scratch_file("unknown.yaml", robot + "speed: fast\n"), "unknown.yaml: speed"},
      {scratch_file("range.yaml", robot + "control: {rate_hz: -1}\n"), "range.yaml: control.rate_hz"},
      {scratch_file("broken.yaml", "robot: [\n"), "broken.yaml"},
      {scratch_file("no_urdf.yaml", "robot: {urdf: none.urdf, base: a, tip: b}\n"), "none.urdf"},
      {scratch_file("bad_urdf.yaml", "robot: {urdf: " + scratch_file("bad.urdf", "<robot") + ", base: a, tip: b}\n"),
       "bad.urdf"},
      {scratch_file("limits.yaml", robot + "limits: {velocity_radps: 0}\n"), "velocity"},
  };
  for (const bool lockstep : {false, true}) {
    for (const auto& bad : cases) {
      LcmPeer peer;
      std::vector<std::string> arguments = {"--config", bad.config};
      if (lockstep) arguments.push_back("--lockstep");
      Process process(controller(arguments));
      const int code = process.wait(kLimit_s);
      const std::string line = line_of(process.output());
      check(code == 2, "%s: code %d", bad.config.c_str(), code);
      check(one_line_with(line, {"controller: ", bad.word}), "%s: '%s'", bad.config.c_str(), line.c_str());
      peer.listen(0.05);
      check(peer.commands.empty() && peer.statuses.empty(), "%s: something was published", bad.config.c_str());
    }
  }
}

void wrong_arguments_end_with_code_2(void**) {
  for (const std::vector<std::string>& arguments :
       std::vector<std::vector<std::string>>{{"--law", "chaos"},
                                             {"--config", "firmware/config/iiwa14-drake.yaml", "--lockstep"},
                                             {"--no-such-option"},
                                             {"--config"},
                                             {"stray"},
                                             {},
                                             {"--urdf", "urdf/lwa3.urdf"}}) {
    Process process(controller(arguments));
    check(process.wait(kLimit_s) == 2, "'%s' ...: %s", arguments.empty() ? "" : arguments[0].c_str(),
          process.output().c_str());
    assert_true(!process.output().empty());
  }
}

void an_impossible_waiting_time_of_the_simulator_is_refused(void**) {
  for (const char* wait : {"nan", "-nan", "inf", "0", "-1", "soon", ""}) {
    Process process({"build/sim", "--scenario", "host/scenarios/paper-c.yaml", "--wait", wait});
    check(process.wait(kLimit_s) == 2, "%s: %s", wait, process.output().c_str());
    check(process.output().find("--wait") != std::string::npos, "%s: %s", wait, process.output().c_str());
  }
}

void help_names_the_options(void**) {
  Process process({"build/controller", "--help"});
  assert_int_equal(process.wait(kLimit_s), 0);
  for (const char* word : {"--config", "--law", "--lockstep", "--lcm-url", "--urdf", "--base", "--tip"})
    check(process.output().find(word) != std::string::npos, "%s is missing", word);
}

void every_program_tells_its_version(void**) {
  std::string version;
  std::ifstream("VERSION") >> version;
  check(!version.empty(), "the file VERSION is empty");
  for (const char* program : {"controller", "sim", "campaign", "replay", "relay", "arm-check"}) {
    Process process({std::string("build/") + program, "--version"});
    assert_int_equal(process.wait(kLimit_s), 0);
    check(process.output() == "Sidestep " + version + "\n", "%s: %s", program, process.output().c_str());
  }
}

void a_wrong_network_ends_with_code_2_and_a_message(void**) {
  Process process({"build/controller", "--config", "firmware/config/lwa3.yaml", "--lcm-url", "carrier-pigeon://"});
  assert_int_equal(process.wait(kLimit_s), 2);
  check(process.output() == "controller: LCM network carrier-pigeon://: only udpm://ADDRESS:PORT is supported\n", "%s",
        process.output().c_str());
}

void the_controller_starts_from_urdf_base_and_tip_without_a_config(void**) {
  LcmPeer peer;
  Process process(controller({"--urdf", "urdf/lwa3.urdf", "--base", "base_link", "--tip", "tool"}));
  check(peer.await([&] { return peer.statuses.size() > 3; }, kLimit_s), "%s", process.output().c_str());
  assert_int_equal(peer.statuses.back().mode, controller_status_t::WAIT);
  process.signal(SIGTERM);
  assert_int_equal(process.wait(kLimit_s), 0);
}

/// systemd restarts a service that stops reporting.
void the_running_loop_is_reported_to_the_service_manager(void**) {
  const test::NotifySocket socket;
  Process process(controller({"--config", "firmware/config/lwa3.yaml"}));
  assert_string_equal(socket.next(10000).c_str(), "READY=1\nWATCHDOG=1");
  for (int i = 0; i < 3; ++i) assert_string_equal(socket.next(3000).c_str(), "WATCHDOG=1");
  process.signal(SIGSTOP);
  while (!socket.next(0).empty()) continue;
  assert_string_equal(socket.next(1500).c_str(), "");
}

void a_signal_before_the_first_message_ends_the_controller(void**) {
  for (const int signal : {SIGTERM, SIGINT}) {
    for (const char* lockstep : {"", "--lockstep"}) {
      std::vector<std::string> arguments = {"--config", "firmware/config/lwa3.yaml"};
      if (*lockstep) arguments.emplace_back(lockstep);
      Process process(controller(arguments));
      const LcmPeer peer;
      assert_int_equal(process.wait(0.5), Process::kStillRunning);
      process.signal(signal);
      const int code = process.wait(2.0);
      check(code == 0, "signal %d %s: code %d, %s", signal, lockstep, code, process.output().c_str());
    }
  }
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test_teardown(a_bad_config_ends_with_code_2_and_one_line_and_publishes_nothing, test::kill_processes),
      cmocka_unit_test_teardown(wrong_arguments_end_with_code_2, test::kill_processes),
      cmocka_unit_test_teardown(an_impossible_waiting_time_of_the_simulator_is_refused, test::kill_processes),
      cmocka_unit_test_teardown(help_names_the_options, test::kill_processes),
      cmocka_unit_test_teardown(every_program_tells_its_version, test::kill_processes),
      cmocka_unit_test_teardown(a_wrong_network_ends_with_code_2_and_a_message, test::kill_processes),
      cmocka_unit_test_teardown(the_controller_starts_from_urdf_base_and_tip_without_a_config, test::kill_processes),
      cmocka_unit_test_teardown(the_running_loop_is_reported_to_the_service_manager, test::kill_processes),
      cmocka_unit_test_teardown(a_signal_before_the_first_message_ends_the_controller, test::kill_processes),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
