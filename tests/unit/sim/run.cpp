#include "host/sim/simulation.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <lcm/lcm-cpp.hpp>
#include <sidestep/controller_status_t.hpp>
#include <sidestep/joint_command_t.hpp>
#include <sidestep/joint_state_t.hpp>
#include <sidestep/obstacles_t.hpp>
#include <sidestep/target_t.hpp>
#include <thread>

#include "tests/support/check.h"
#include "tests/support/lcm_peer.h"

using namespace sidestep::sim;
namespace wire = sidestep;

namespace {

const std::atomic<bool> kNotInterrupted{false};

Scenario scenario_of(double duration_s) {
  Scenario scenario = load_scenario("host/scenarios/paper-c.yaml").front();
  scenario.periods = static_cast<int>(std::lround(duration_s * 100));
  return scenario;
}

/// A controller in a separate thread. It calls a function for each ARM_STATE and stores the messages it receives.
class StandIn {
 public:
  using Respond = std::function<void(StandIn&, int64_t utime, int cycle)>;

  explicit StandIn(Respond respond) : respond_(std::move(respond)), lcm_(sidestep::test::private_lcm_url()) {
    lcm_.subscribe("ARM_STATE", &StandIn::on_arm, this)->setQueueCapacity(1000);
    lcm_.subscribe("OBSTACLES", &StandIn::on_obstacles, this)->setQueueCapacity(1000);
    lcm_.subscribe("TARGET", &StandIn::on_target, this)->setQueueCapacity(1000);
    thread_ = std::thread([this] {
      while (!over_) lcm_.handleTimeout(10);
    });
  }
  ~StandIn() { stop(); }
  StandIn(const StandIn&) = delete;
  StandIn& operator=(const StandIn&) = delete;

  void stop() {
    over_ = true;
    if (thread_.joinable()) thread_.join();
  }

  void command(int64_t utime, const std::vector<double>& qd_radps) {
    wire::joint_command_t message{};
    message.utime = utime;
    message.num_joints = static_cast<int32_t>(qd_radps.size());
    message.joint_position = message.joint_velocity = qd_radps;
    lcm_.publish("ARM_COMMAND", &message);
  }

  void status(int64_t utime, bool tracks, const std::string& link = "", const std::string& text = "holding") {
    wire::controller_status_t message{};
    message.utime = utime;
    message.mode = tracks ? wire::controller_status_t::TRACK : wire::controller_status_t::HOLD;
    message.nearest_link = link;
    message.message = text;
    lcm_.publish("CONTROLLER_STATUS", &message);
  }

  void send_obstacle() {
    wire::obstacles_t message{};
    message.num_obstacles = 1;
    message.obstacles.resize(1);
    lcm_.publish("OBSTACLES", &message);
  }

  void bytes(const std::string& channel, const std::vector<uint8_t>& data) {
    lcm_.publish(channel, data.data(), static_cast<unsigned>(data.size()));
  }

  std::vector<wire::joint_state_t> arms;
  std::vector<wire::obstacles_t> obstacles;
  std::vector<wire::target_t> targets;

 private:
  void on_arm(const lcm::ReceiveBuffer*, const std::string&, const wire::joint_state_t* message) {
    arms.push_back(*message);
    respond_(*this, message->utime, static_cast<int>(arms.size()) - 1);
  }
  void on_obstacles(const lcm::ReceiveBuffer*, const std::string&, const wire::obstacles_t* message) {
    obstacles.push_back(*message);
  }
  void on_target(const lcm::ReceiveBuffer*, const std::string&, const wire::target_t* message) {
    targets.push_back(*message);
  }

  Respond respond_;
  lcm::LCM lcm_;
  std::atomic<bool> over_{false};
  std::thread thread_;
};

std::vector<double> wave(int cycle) {
  std::vector<double> qd_radps(7);
  for (size_t i = 0; i < 7; ++i) qd_radps[i] = std::sin(0.1 * cycle + static_cast<double>(i));
  return qd_radps;
}

/// Answers with a command and a status: HOLD in the first ten cycles, then TRACK.
void respond_well(StandIn& controller, int64_t utime, int cycle) {
  controller.command(utime, cycle < 10 ? std::vector<double>(7, 0.0) : wave(cycle));
  controller.status(utime, cycle >= 10);
}

struct Result {
  Outcome outcome;
  int periods;
  JointVector q_rad;
  int64_t refused, malformed;
  std::string waits_for;
};

Result simulate(const Scenario& scenario, bool lockstep, double patience_s = 5, const std::string& csv_file = "",
                const std::atomic<bool>& interrupted = kNotInterrupted) {
  SimWire wire(sidestep::test::private_lcm_url(), "", {scenario.channels});
  wire.leave_to_others(0, scenario.world);
  std::vector<Run> runs;
  runs.emplace_back(scenario, csv_file);
  Simulation all(std::move(runs), ProgressLine(true, lockstep));
  const Outcome outcome = (lockstep ? run_lockstep : run_realtime)(all, wire, patience_s, interrupted);
  const Run& run = all.runs.front();
  return {outcome, run.summary().rows(), run.plant.q_rad(), run.plant.refused(), wire.malformed(), run.waits_for()};
}

void lockstep_sends_all_messages_with_one_utime_and_keeps_the_world_at_rest_until_track(void**) {
  StandIn controller(respond_well);
  const Result result = simulate(scenario_of(0.5), true);
  controller.stop();
  assert_true(result.outcome == Outcome::kDone);
  assert_int_equal(result.periods, 51);
  assert_int_equal(controller.arms.size(), 10 + 51);
  assert_int_equal(controller.obstacles.size(), controller.arms.size());
  for (size_t k = 0; k < controller.arms.size(); ++k) {
    const int64_t utime = controller.arms[k].utime;
    // After the first answer the clock jumps to the start of every run.
    if (k > 0) assert_int_equal(utime, 1'000'000'000 + static_cast<int64_t>(k) * 10'000);
    assert_int_equal(controller.obstacles[k].utime, utime);
    assert_int_equal(controller.targets[k].utime, utime);
    const double t_s = k < 10 ? 0.0 : 0.01 * static_cast<double>(k - 10);
    check_near(controller.obstacles[k].obstacles[0].position[0], 0.3 + 0.2 * t_s, 1e-15);
    check_near(controller.obstacles[k].obstacles[0].velocity[0], 0.2, 0);
    check_near(controller.targets[k].position[0], 0.1 + 0.2 * t_s, 1e-15);
  }
}

/// The other process is silent from cycle 21 on; the simulator notices after cycle 30.
void without_own_obstacles_the_empty_set_is_sent_while_nobody_else_sends_any(void**) {
  StandIn controller([](StandIn& self, int64_t utime, int cycle) {
    if (cycle == 20) self.send_obstacle();
    if (cycle == 30) std::this_thread::sleep_for(std::chrono::milliseconds(1100));
    self.command(utime, std::vector<double>(7, 0.0));
    self.status(utime, false);
  });
  Scenario scenario = scenario_of(0.5);
  scenario.world = {};
  scenario.world.obstacles_from_others = true;
  const Result result = simulate(scenario, true);
  controller.stop();
  assert_true(result.outcome == Outcome::kDone);  // without a target it starts in HOLD
  assert_int_equal(controller.targets.size(), 0);
  const std::vector<wire::obstacles_t>& sets = controller.obstacles;
  assert_int_equal(std::count_if(sets.begin(), sets.end(), [](const auto& set) { return set.num_obstacles == 1; }), 1);
  assert_int_equal(controller.arms.size(), 51);
  assert_int_equal(sets.size(), 21 + 1 + 20);
}

void a_scenario_without_end_runs_until_it_is_interrupted(void**) {
  std::atomic<bool> interrupted{false};
  StandIn controller([&](StandIn& self, int64_t utime, int cycle) {
    respond_well(self, utime, cycle);
    if (cycle == 400) interrupted = true;
  });
  const Result result = simulate(scenario_of(0), true, 5, "", interrupted);
  assert_true(result.outcome == Outcome::kInterrupted);
  check(result.periods > 350, "%d periods", result.periods);
}

void the_plant_follows_each_command_over_one_period(void**) {
  StandIn controller(respond_well);
  simulate(scenario_of(0.3), true);
  controller.stop();
  for (size_t k = 10; k + 1 < controller.arms.size(); ++k) {
    const wire::joint_state_t &now = controller.arms[k], &next = controller.arms[k + 1];
    for (size_t i = 0; i < 7; ++i) {
      const double command_radps = wave(static_cast<int>(k))[i];
      check_near(next.joint_position[i], now.joint_position[i] + command_radps * 0.01, 0);
      check_near(next.joint_velocity[i], command_radps, 0);
    }
  }
}

std::string content_of(const std::filesystem::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

void two_lockstep_runs_are_bit_identical(void**) {
  const auto file = std::filesystem::temp_directory_path() / ("sim_run." + std::to_string(getpid()) + ".csv");
  std::string runs[2];
  for (std::string& run : runs) {
    StandIn controller(respond_well);
    simulate(scenario_of(0.5), true, 5, file.string());
    run = content_of(file);
  }
  std::filesystem::remove(file);
  check(runs[0].size() > 10'000, "only %zu bytes", runs[0].size());
  assert_true(runs[0] == runs[1]);
}

void the_simulation_ends_when_no_controller_answers(void**) {
  for (const bool lockstep : {true, false}) {
    const Result result = simulate(scenario_of(0.5), lockstep, 0.3);
    assert_true(result.outcome == Outcome::kNeverTracked);
    check(result.waits_for.find("no message on") != std::string::npos, "%s", result.waits_for.c_str());
  }
}

void the_simulation_ends_with_a_reason_when_the_controller_never_tracks(void**) {
  for (const bool lockstep : {true, false}) {
    StandIn controller([](StandIn& self, int64_t utime, int) {
      self.command(utime, std::vector<double>(7, 0.0));
      self.status(utime, false);
    });
    const Result result = simulate(scenario_of(0.5), lockstep, 0.3);
    assert_true(result.outcome == Outcome::kNeverTracked);
    check(result.waits_for.find("holding") != std::string::npos, "%s", result.waits_for.c_str());
  }
}

void a_controller_that_stops_sending_is_lost(void**) {
  StandIn controller([](StandIn& self, int64_t utime, int cycle) {
    if (cycle < 20) respond_well(self, utime, cycle);
  });
  const Result result = simulate(scenario_of(0.5), true);
  assert_true(result.outcome == Outcome::kLost);
  assert_int_equal(result.periods, 10);
}

void an_interrupt_ends_the_simulation(void**) {
  const std::atomic<bool> interrupted{true};
  for (const bool lockstep : {true, false}) {
    assert_true(simulate(scenario_of(0.5), lockstep, 5, "", interrupted).outcome == Outcome::kInterrupted);
  }
}

template <typename Message>
std::vector<uint8_t> encoded(const Message& message) {
  std::vector<uint8_t> data(static_cast<size_t>(message.getEncodedSize()));
  message.encode(data.data(), 0, static_cast<int>(data.size()));
  return data;
}

constexpr uint8_t kHostileFirstBytes[] = {0x7f, 0xff, 0x80};  // of a count or length: huge and negative

/// Sends the message with its four bytes at `at`, a count or length, replaced by hostile ones.
void send_hostile(StandIn& controller, const std::string& channel, std::vector<uint8_t> data, size_t at) {
  for (const uint8_t first : kHostileFirstBytes) {
    data[at] = first;
    controller.bytes(channel, data);
  }
}

/// Offset of the length of the text that consists of this letter; all numbers of the message are 0.
size_t length_of_text_at(const std::vector<uint8_t>& data, char letter) {
  constexpr size_t kHash = 8, kLength = 4;
  return static_cast<size_t>(std::find(data.begin() + kHash, data.end(), letter) - data.begin()) - kLength;
}

constexpr int kHostileMessages = 2 + 3 * 3;

void send_hostile_messages(StandIn& controller, int64_t utime, int cycle) {
  std::vector<double> qd_radps = wave(cycle);
  qd_radps[3] = std::nan("");
  controller.command(utime - 1, qd_radps);  // well-formed, but with another utime
  controller.bytes("ARM_COMMAND", {});
  controller.bytes("ARM_COMMAND", {1, 2, 3});
  const std::vector<uint8_t> command = encoded(wire::joint_command_t{});
  send_hostile(controller, "ARM_COMMAND", command, command.size() - sizeof(int32_t));  // ends with the joint count
  wire::controller_status_t status{};
  status.nearest_link = "L";
  status.message = "M";
  const std::vector<uint8_t> data = encoded(status);
  for (const char letter : {'L', 'M'})
    send_hostile(controller, "CONTROLLER_STATUS", data, length_of_text_at(data, letter));
}

void texts_of_any_length_are_decoded(void**) {
  StandIn controller([](StandIn& self, int64_t utime, int cycle) {
    self.command(utime, std::vector<double>(7, 0.0));
    self.status(utime, cycle >= 10, std::string(static_cast<size_t>(cycle % 5) * 100, 'l'), std::string(300, 'm'));
  });
  const Result result = simulate(scenario_of(0.3), true);
  assert_true(result.outcome == Outcome::kDone);
  assert_int_equal(result.malformed, 0);
}

void hostile_messages_are_counted_and_have_no_effect(void**) {
  JointVector q_rad[2];
  for (const bool hostile : {false, true}) {
    StandIn controller([hostile](StandIn& self, int64_t utime, int cycle) {
      if (hostile) send_hostile_messages(self, utime, cycle);
      respond_well(self, utime, cycle);
    });
    const Result result = simulate(scenario_of(0.3), true);
    assert_true(result.outcome == Outcome::kDone);
    assert_int_equal(result.malformed, hostile ? kHostileMessages * 41 : 0);
    q_rad[hostile] = result.q_rad;
  }
  check_near(q_rad[1], q_rad[0], 0);
}

void after_a_refused_command_the_last_one_stays_in_effect(void**) {
  StandIn controller([](StandIn& self, int64_t utime, int cycle) {
    self.command(utime, std::vector<double>(cycle == 20 ? 6 : 7, cycle == 21 ? std::nan("") : 0.1));
    self.status(utime, true);
  });
  const Result result = simulate(scenario_of(0.3), true);
  assert_int_equal(result.refused, 2);
  check_near(result.q_rad[0], 0.03, 1e-12);
}

void real_time_lasts_its_duration_and_sends_the_arm_state_every_2_ms(void**) {
  StandIn controller(respond_well);
  const auto start = std::chrono::steady_clock::now();
  const Result result = simulate(scenario_of(0.4), false);
  const double took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  controller.stop();
  assert_true(result.outcome == Outcome::kDone);
  assert_int_equal(result.periods, 41);
  check(took_s > 0.4 && took_s < 2, "%g s", took_s);
  check(controller.arms.size() > 100 && controller.arms.size() < 1000, "%zu arm states", controller.arms.size());
  check(controller.obstacles.size() >= 20, "%zu obstacle messages", controller.obstacles.size());
  check_near(controller.obstacles[0].obstacles[0].position[0], 0.3, 0);
  const double travelled_m = controller.obstacles.back().obstacles[0].position[0] - 0.3;
  check(travelled_m > 0.02 && travelled_m <= 0.08 + 1e-12, "%g m", travelled_m);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(lockstep_sends_all_messages_with_one_utime_and_keeps_the_world_at_rest_until_track),
      cmocka_unit_test(without_own_obstacles_the_empty_set_is_sent_while_nobody_else_sends_any),
      cmocka_unit_test(a_scenario_without_end_runs_until_it_is_interrupted),
      cmocka_unit_test(the_plant_follows_each_command_over_one_period),
      cmocka_unit_test(two_lockstep_runs_are_bit_identical),
      cmocka_unit_test(the_simulation_ends_when_no_controller_answers),
      cmocka_unit_test(the_simulation_ends_with_a_reason_when_the_controller_never_tracks),
      cmocka_unit_test(a_controller_that_stops_sending_is_lost),
      cmocka_unit_test(an_interrupt_ends_the_simulation),
      cmocka_unit_test(texts_of_any_length_are_decoded),
      cmocka_unit_test(hostile_messages_are_counted_and_have_no_effect),
      cmocka_unit_test(after_a_refused_command_the_last_one_stays_in_effect),
      cmocka_unit_test(real_time_lasts_its_duration_and_sends_the_arm_state_every_2_ms),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
