#include <fmt/format.h>

#include <csignal>
#include <iostream>

#include "firmware/base/command_line.h"
#include "firmware/base/log.h"
#include "firmware/io/config/config.h"
#include "firmware/io/lcm/lcm_url.h"
#include "firmware/io/loop/cycle_clock.h"
#include "firmware/io/loop/loop.h"

namespace {

sidestep::Requests requests;

void take_request(int signal) {
  (signal == SIGUSR1 ? requests.write_blackbox : requests.stop) = true;
}

void catch_signals() {
  struct sigaction action {};
  action.sa_handler = take_request;
  for (const int signal : {SIGINT, SIGTERM, SIGUSR1}) sigaction(signal, &action, nullptr);
  // nohup wants it ignored.
  if (std::signal(SIGHUP, SIG_IGN) != SIG_IGN) sigaction(SIGHUP, &action, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
}

struct Arguments {
  std::string config;
  sidestep::Overrides overrides;
  std::string lcm_url;
  bool lockstep = false;
};

void describe(sidestep::CommandLine& app, Arguments& arguments) {
  app.add_option("--config", arguments.config, "YAML file of the robot, such as lwa3.yaml");
  app.add_option("--law", arguments.overrides.law, "the law, over the configuration's").one_of({"sidestep", "paper"});
  app.add_option("--rate", arguments.overrides.rate_hz, "cycles a second, over the configuration's")
      .type_name("HZ")
      .range(10.0, 2000.0);
  app.add_flag("--lockstep", arguments.lockstep, "one cycle for every arm state, on the arm's clock");
  app.add_option("--lcm-url", arguments.lcm_url, "LCM network (default: LCM_DEFAULT_URL or LCM's own)");
  app.add_option("--urdf", arguments.overrides.urdf, "robot description, over the configuration's");
  app.add_option("--base", arguments.overrides.base, "base link, over the configuration's");
  app.add_option("--tip", arguments.overrides.tip, "tip link, the tool, over the configuration's");
  app.footer(
      "Stops on Ctrl-C, SIGTERM or SIGHUP: brakes the arm to rest, then exits with 0. SIGUSR1 writes a blackbox log.\n"
      "Exit codes: 0 stopped as asked, 1 failed while running, 2 wrong arguments, configuration or URDF.");
}

int run(const Arguments& arguments) {
  using namespace sidestep;
  Config config;
  try {
    config = load_config(arguments.config, arguments.overrides);
    if (arguments.lockstep && config.dialect->no_lockstep)
      throw std::runtime_error(std::string("--lockstep: not with ") + config.dialect->no_lockstep);
    check_lcm_url(arguments.lcm_url);
  } catch (const std::exception& error) {
    std::cerr << "controller: " << error.what() << "\n";
    return 2;
  }
  const Settings& settings = config.model.settings;
  log_info(fmt::format("{} joints, {} link shapes, {:g} Hz{}, law {}", config.model.arm.joints,
                       config.model.arm.shapes.size(), settings.rate_hz, arguments.lockstep ? " in lockstep" : "",
                       settings.law == Law::kPaper ? "paper" : "sidestep"));
  for (const std::string& warning : config.warnings) log_warning("warning: " + warning);
  const auto loop = arguments.lockstep ? run_lockstep : run_realtime;
  const LoopSummary summary = loop(config, arguments.lcm_url, requests);
  const Reception& reception = summary.reception;
  log_info(fmt::format(
      "{} cycles, {} skipped; {} messages rejected, {} incomplete; {} datagrams lost, {} malformed\n{}",
      summary.timing.cycles, summary.timing.skipped_cycles, summary.rejected_messages, reception.incomplete_messages,
      reception.lost_datagrams, reception.malformed_datagrams, table(summary.timing)));
  return 0;
}

int start(int argc, char** argv) {
  sidestep::CommandLine app{
      "Sidestep controller: steers a redundant arm to a moving target while the whole arm keeps clear of "
      "moving obstacles."};
  Arguments arguments;
  describe(app, arguments);
  if (const auto exit_code = app.parse(argc, argv)) return *exit_code;
  catch_signals();
  return run(arguments);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return start(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "controller: " << error.what() << "\n";
    return 1;
  }
}
