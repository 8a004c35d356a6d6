#include "host/sim/play.h"

#include <unistd.h>

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

using namespace sidestep::sim;
namespace wire = sidestep;

namespace {

const std::atomic<bool> kNotInterrupted{false};

/// A port of its own, should the tests not have a network of their own.
std::string url() {
  return "udpm://239.255.76.67:" + std::to_string(20'000 + getpid() % 40'000) + "?ttl=0";
}

Scenario scenario_of(double duration_s) {
  Scenario scenario = load_scenario("host/scenarios/paper-c.yaml").front();
  scenario.periods = static_cast<int>(std::lround(duration_s * 100));
  return scenario;
}

/// A controller in a thread of its own that answers every ARM_STATE, from the tenth on with TRACK, and keeps what it
/// saw.
class StandIn {
 public:
  using Answer = std::function<void(StandIn&, int64_t utime, int cycle)>;

  explicit StandIn(Answer answer) : answer_(std::move(answer)), lcm_(url()) {
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

  void status(int64_t utime, bool tracks) {
    wire::controller_status_t message{};
    message.utime = utime;
    message.mode = tracks ? wire::controller_status_t::TRACK : wire::controller_status_t::HOLD;
    message.message = "holding";
    lcm_.publish("CONTROLLER_STATUS", &message);
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
    answer_(*this, message->utime, static_cast<int>(arms.size()) - 1);
  }
  void on_obstacles(const lcm::ReceiveBuffer*, const std::string&, const wire::obstacles_t* message) {
    obstacles.push_back(*message);
  }
  void on_target(const lcm::ReceiveBuffer*, const std::string&, const wire::target_t* message) {
    targets.push_back(*message);
  }

  Answer answer_;
  lcm::LCM lcm_;
  std::atomic<bool> over_{false};
  std::thread thread_;
};

std::vector<double> wave(int cycle) {
  std::vector<double> qd_radps(7);
  for (size_t i = 0; i < 7; ++i) qd_radps[i] = std::sin(0.1 * cycle + static_cast<double>(i));
  return qd_radps;
}

void answer_well(StandIn& controller, int64_t utime, int cycle) {
  controller.command(utime, cycle < 10 ? std::vector<double>(7, 0.0) : wave(cycle));
  controller.status(utime, cycle >= 10);
}

struct Played {
  End end;
  int periods;
  JointVector q_rad;
  int64_t refused, malformed;
  std::string waits_for;
};

Played play(const Scenario& scenario, bool lockstep, double patience_s = 5, const std::string& csv_file = "",
            const std::atomic<bool>& interrupted = kNotInterrupted) {
  Bus bus(url(), "", {scenario.channels});
  std::vector<Run> runs;
  runs.emplace_back(scenario, csv_file);
  Play all(std::move(runs), Live(true, lockstep));
  const End end = (lockstep ? run_lockstep : run_realtime)(all, bus, patience_s, interrupted);
  const Run& run = all.runs.front();
  return {end, run.summary().rows(), run.plant.q_rad(), run.plant.refused(), bus.malformed(), run.waits_for()};
}

void lockstep_sends_everything_with_one_utime_and_holds_the_world_until_track(void**) {
  StandIn controller(answer_well);
  const Played played = play(scenario_of(0.5), true);
  controller.stop();
  assert_true(played.end == End::kDone);
  assert_int_equal(played.periods, 51);
  assert_int_equal(controller.arms.size(), 10 + 51);
  assert_int_equal(controller.obstacles.size(), controller.arms.size());
  for (size_t k = 0; k < controller.arms.size(); ++k) {
    const int64_t utime = controller.arms[k].utime;
    assert_int_equal(utime, controller.arms[0].utime + static_cast<int64_t>(k) * 10'000);
    assert_int_equal(controller.obstacles[k].utime, utime);
    assert_int_equal(controller.targets[k].utime, utime);
    const double t_s = k < 10 ? 0.0 : 0.01 * static_cast<double>(k - 10);
    check_near(controller.obstacles[k].obstacles[0].position[0], 0.3 + 0.2 * t_s, 1e-15);
    check_near(controller.obstacles[k].obstacles[0].velocity[0], 0.2, 0);
    check_near(controller.targets[k].position[0], 0.1 + 0.2 * t_s, 1e-15);
  }
}

void the_plant_follows_each_command_over_one_period(void**) {
  StandIn controller(answer_well);
  play(scenario_of(0.3), true);
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

void two_lockstep_runs_are_the_same_to_the_last_bit(void**) {
  const auto file = std::filesystem::temp_directory_path() / ("sim_run." + std::to_string(getpid()) + ".csv");
  std::string runs[2];
  for (std::string& run : runs) {
    StandIn controller(answer_well);
    play(scenario_of(0.5), true, 5, file.string());
    run = content_of(file);
  }
  std::filesystem::remove(file);
  check(runs[0].size() > 10'000, "only %zu bytes", runs[0].size());
  assert_true(runs[0] == runs[1]);
}

void gives_up_when_no_controller_comes(void**) {
  for (const bool lockstep : {true, false}) {
    const Played played = play(scenario_of(0.5), lockstep, 0.3);
    assert_true(played.end == End::kNeverTracked);
    check(played.waits_for.find("nothing heard") != std::string::npos, "%s", played.waits_for.c_str());
  }
}

void gives_up_when_the_controller_never_tracks_and_says_why(void**) {
  for (const bool lockstep : {true, false}) {
    StandIn controller([](StandIn& self, int64_t utime, int) {
      self.command(utime, std::vector<double>(7, 0.0));
      self.status(utime, false);
    });
    const Played played = play(scenario_of(0.5), lockstep, 0.3);
    assert_true(played.end == End::kNeverTracked);
    check(played.waits_for.find("holding") != std::string::npos, "%s", played.waits_for.c_str());
  }
}

void a_controller_that_falls_silent_is_lost(void**) {
  StandIn controller([](StandIn& self, int64_t utime, int cycle) {
    if (cycle < 20) answer_well(self, utime, cycle);
  });
  const Played played = play(scenario_of(0.5), true);
  assert_true(played.end == End::kLost);
  assert_int_equal(played.periods, 10);
}

void an_interrupt_ends_the_run(void**) {
  const std::atomic<bool> interrupted{true};
  for (const bool lockstep : {true, false}) {
    assert_true(play(scenario_of(0.5), lockstep, 5, "", interrupted).end == End::kInterrupted);
  }
}

void poison(StandIn& controller, int64_t utime, int cycle) {
  std::vector<double> qd_radps = wave(cycle);
  qd_radps[3] = std::nan("");
  controller.command(utime - 1, qd_radps);  // not an answer
  controller.bytes("ARM_COMMAND", {});
  controller.bytes("ARM_COMMAND", {1, 2, 3});
  wire::joint_command_t command{};
  std::vector<uint8_t> data(static_cast<size_t>(command.getEncodedSize()));
  command.encode(data.data(), 0, static_cast<int>(data.size()));
  for (const uint8_t first : {0x7f, 0xff, 0x80}) {  // counts: huge and negative
    data[24] = first;
    controller.bytes("ARM_COMMAND", data);
  }
  wire::controller_status_t status{};
  data.resize(static_cast<size_t>(status.getEncodedSize()));
  status.encode(data.data(), 0, static_cast<int>(data.size()));
  for (const uint8_t first : {0x7f, 0xff, 0x80}) {  // lengths of a text: huge and negative
    data[101] = first;
    controller.bytes("CONTROLLER_STATUS", data);
  }
}

void hostile_messages_are_counted_and_change_nothing(void**) {
  JointVector q_rad[2];
  for (const bool hostile : {false, true}) {
    StandIn controller([hostile](StandIn& self, int64_t utime, int cycle) {
      if (hostile) poison(self, utime, cycle);
      answer_well(self, utime, cycle);
    });
    const Played played = play(scenario_of(0.3), true);
    assert_true(played.end == End::kDone);
    assert_int_equal(played.malformed, hostile ? 8 * 41 : 0);
    q_rad[hostile] = played.q_rad;
  }
  check_near(q_rad[1], q_rad[0], 0);
}

void refused_commands_leave_the_last_one_in_force(void**) {
  StandIn controller([](StandIn& self, int64_t utime, int cycle) {
    self.command(utime, std::vector<double>(cycle == 20 ? 6 : 7, cycle == 21 ? std::nan("") : 0.1));
    self.status(utime, true);
  });
  const Played played = play(scenario_of(0.3), true);
  assert_int_equal(played.refused, 2);
  check_near(played.q_rad[0], 0.03, 1e-12);
}

void real_time_takes_as_long_as_it_says_and_sends_the_arm_every_2_ms(void**) {
  StandIn controller(answer_well);
  const auto start = std::chrono::steady_clock::now();
  const Played played = play(scenario_of(0.4), false);
  const double took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  controller.stop();
  assert_true(played.end == End::kDone);
  assert_int_equal(played.periods, 41);
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
      cmocka_unit_test(lockstep_sends_everything_with_one_utime_and_holds_the_world_until_track),
      cmocka_unit_test(the_plant_follows_each_command_over_one_period),
      cmocka_unit_test(two_lockstep_runs_are_the_same_to_the_last_bit),
      cmocka_unit_test(gives_up_when_no_controller_comes),
      cmocka_unit_test(gives_up_when_the_controller_never_tracks_and_says_why),
      cmocka_unit_test(a_controller_that_falls_silent_is_lost),
      cmocka_unit_test(an_interrupt_ends_the_run),
      cmocka_unit_test(hostile_messages_are_counted_and_change_nothing),
      cmocka_unit_test(refused_commands_leave_the_last_one_in_force),
      cmocka_unit_test(real_time_takes_as_long_as_it_says_and_sends_the_arm_every_2_ms),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
