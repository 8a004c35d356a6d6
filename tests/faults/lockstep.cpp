#include <cmath>
#include <csignal>

#include "tests/support/check.h"
#include "tests/support/lcm_peer.h"
#include "tests/support/process.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::arm_state_message;
using test::Bytes;
using test::LcmPeer;
using test::obstacles_message;
using test::private_lcm_url;
using test::Process;
using test::Random;
using test::target_message;

namespace {

constexpr int64_t kPeriod_us = 10000;
const char* const kLaws[] = {"paper", "sidestep"};

Process start_controller(const std::string& law) {
  return Process({"build/controller", "--config", "firmware/config/lwa3.yaml", "--law", law, "--lockstep", "--lcm-url",
                  private_lcm_url()});
}

/// An ideal arm and a small world, in lockstep with a controller in another process.
class Play {
 public:
  explicit Play(const std::string& law)
      : controller_(start_controller(law)), q_rad_(JointVector::Zero(7)), qd_radps_(JointVector::Zero(7)) {
    q_rad_[1] = M_PI / 2;
    q_rad_[3] = -M_PI / 2;
    // Messages are lost until the controller subscribes; its first answer shows that it has.
    for (int i = 0; i < 200 && peer.commands.empty(); ++i) {
      send_arm();
      peer.await([&] { return !peer.statuses.empty(); }, 0.05);
    }
    check(!peer.commands.empty(), "the controller does not answer: %s", controller_.output().c_str());
    peer.listen(0.2);
    clear();
    pause(10.0);  // earlier messages are then too old to count
  }

  /// One cycle: sends the world, then the arm, and waits for the answer.
  void cycle() {
    send_world();
    answer();
  }

  /// Target and obstacles of the next cycle.
  void send_world() {
    utime_ += kPeriod_us;
    const double t_s = 0.01 * static_cast<double>(cycles_++);
    const Vector3 position_m(-0.1, 0.3 + 0.05 * std::sin(t_s), 0.8), velocity_mps(0, 0.05 * std::cos(t_s), 0);
    peer.send("TARGET", target_message(utime_, position_m, velocity_mps));
    const Vector3 v(0, -0.05, 0);
    peer.send("OBSTACLES", obstacles_message(utime_, {test::sphere(1, Vector3(0.1, 0.5, 0.6) + t_s * v, 0.05, v)}));
  }

  /// Sends the arm and waits for the answer.
  void answer() {
    const size_t before = peer.statuses.size();
    send_arm();
    check(peer.await([&] { return peer.statuses.size() > before; }, 2.0), "no answer to utime %ld: %s", utime_,
          controller_.output().c_str());
    const joint_command_t& command = peer.commands.back();
    qd_radps_ = Eigen::Map<const Eigen::VectorXd>(command.joint_velocity.data(), 7);
    q_rad_ += 0.01 * qd_radps_;
  }

  void send_arm() { peer.send("ARM_STATE", arm_state_message(utime_, q_rad_, qd_radps_)); }

  void clear() {
    peer.commands.clear();
    peer.statuses.clear();
    peer.command_bytes.clear();
    peer.order.clear();
  }

  int64_t utime() const { return utime_; }
  void pause(double duration_s) { utime_ += static_cast<int64_t>(duration_s * 1e6); }

  LcmPeer peer;

 private:
  Process controller_;
  JointVector q_rad_, qd_radps_;
  int64_t utime_ = 1000;
  int64_t cycles_ = 0;
};

void every_arm_state_is_answered_once_command_first(void**) {
  Play play("sidestep");
  std::string expected;
  for (int i = 0; i < 300; ++i) {
    play.cycle();
    expected += "cs";
    assert_int_equal(play.peer.commands.back().utime, play.utime());
    assert_int_equal(play.peer.statuses.back().utime, play.utime());
    assert_int_equal(play.peer.statuses.back().seq, play.peer.commands.back().seq);
    assert_int_equal(play.peer.commands.back().num_joints, 7);
  }
  play.peer.listen(0.1);
  assert_string_equal(play.peer.order.c_str(), expected.c_str());
  for (size_t i = 1; i < play.peer.commands.size(); ++i)
    assert_int_equal(play.peer.commands[i].seq, play.peer.commands[i - 1].seq + 1);
}

/// States that arrive faster than they are answered are all answered in order. Their number is what a socket can buffer
/// together with the answers while a busy machine does not read it.
void a_burst_of_arm_states_is_answered_one_by_one(void**) {
  Play play("paper");
  std::vector<int64_t> sent;
  JointVector q_rad = JointVector::Zero(7);
  for (int64_t i = 1; i <= 40; ++i) {
    sent.push_back(play.utime() + i * kPeriod_us);
    play.peer.send("ARM_STATE", arm_state_message(sent.back(), q_rad, JointVector::Zero(7)));
  }
  assert_true(play.peer.await([&] { return play.peer.statuses.size() >= sent.size(); }, 5.0));
  play.peer.listen(0.1);
  assert_int_equal(play.peer.commands.size(), sent.size());
  for (size_t i = 0; i < sent.size(); ++i) assert_int_equal(play.peer.commands[i].utime, sent[i]);
}

void a_repeated_arm_state_is_not_answered_again(void**) {
  Play play("paper");
  play.cycle();
  play.cycle();
  play.clear();
  play.send_arm();
  play.peer.listen(0.2);
  assert_string_equal(play.peer.order.c_str(), "");
  play.cycle();
  assert_string_equal(play.peer.order.c_str(), "cs");
}

/// The network duplicates the first state after a pause of the arm's clock.
void a_repeated_arm_state_after_a_pause_is_not_answered_again(void**) {
  Play play("paper");
  play.cycle();
  play.pause(1.0);
  play.cycle();
  play.clear();
  play.send_arm();
  play.peer.listen(0.2);
  assert_string_equal(play.peer.order.c_str(), "");
}

void the_arm_reaches_the_target(void**) {
  for (const char* law : kLaws) {
    Play play(law);
    for (int i = 0; i < 800; ++i) play.cycle();
    const controller_status_t& status = play.peer.statuses.back();
    assert_int_equal(status.mode, controller_status_t::TRACK);
    check(status.target_distance < 0.01, "%s: %g m left", law, status.target_distance);
    assert_string_equal(status.message.c_str(), "tracking");
    assert_int_equal(status.rejected_messages, 0);
    assert_int_equal(status.nearest_obstacle, 1);
    check(status.clearance > 0 && status.clearance < 1, "%s: clearance %g m", law, status.clearance);
  }
}

/// Both controllers answer every arm state with the same utime. Neither may move the arm then.
void the_arm_rests_while_a_second_controller_runs(void**) {
  Play play("sidestep");
  for (int i = 0; i < 100; ++i) play.cycle();
  assert_int_equal(play.peer.statuses.back().mode, controller_status_t::TRACK);
  Process second = start_controller("paper");
  play.clear();
  for (int i = 0; i < 200 && play.peer.statuses.size() <= static_cast<size_t>(i); ++i) {
    play.cycle();
    play.peer.listen(0.02);
  }
  for (int i = 0; i < 100; ++i) {
    play.cycle();
    play.peer.listen(0.005);
  }
  play.clear();
  for (int i = 0; i < 20; ++i) {
    play.cycle();
    play.peer.listen(0.005);
  }
  assert_int_equal(play.peer.commands.size(), 40);
  for (const controller_status_t& status : play.peer.statuses)
    check(status.message.find("another controller") != std::string::npos, "%s", status.message.c_str());
  for (const joint_command_t& command : play.peer.commands)
    for (const double velocity_radps : command.joint_velocity) check_near(velocity_radps, 0.0, 0);
  second.signal(SIGKILL);
  for (int i = 0; i < 120; ++i) play.cycle();
  assert_int_equal(play.peer.statuses.back().mode, controller_status_t::TRACK);
}

struct Transcript {
  std::vector<Bytes> commands, statuses;
  int64_t rejected = 0, hostile = 0;
};

/// A valid message with one error, and its channel.
std::pair<std::string, Bytes> hostile_message(Random& random, int64_t utime) {
  const struct {
    const char* channel;
    Bytes bytes;
    size_t number_at;  ///< the first double
  } good[] = {
      {"TARGET", test::encoded(target_message(utime, Vector3(9, 9, 9), Vector3(0, 0, 0))), 16},
      {"OBSTACLES",
       test::encoded(obstacles_message(utime, {test::sphere(9, Vector3(0, 0.3, 0.8), 0.2, Vector3(0, 0, 0))})), 25},
      {"ARM_STATE", test::encoded(arm_state_message(utime, JointVector::Ones(7), JointVector::Ones(7))), 20},
  };
  auto [channel, bytes, number_at] = good[random.index(3)];
  switch (random.index(4)) {
    case 0:
      bytes.resize(static_cast<size_t>(random.index(static_cast<int>(bytes.size()))));
      break;
    case 1:
      bytes[static_cast<size_t>(random.index(8))] ^= 1;
      break;
    case 2:
      bytes.resize(bytes.size() + static_cast<size_t>(1 + random.index(50000)));
      break;
    default:
      bytes[number_at] = 0x7f, bytes[number_at + 1] = 0xff;
      break;  // NaN
  }
  return {channel, bytes};
}

/// Plays the same 400 cycles. hostile: with invalid messages in between, which must not change anything.
Transcript record(const std::string& law, bool hostile) {
  Play play(law);
  Random random(1);
  Transcript transcript;
  play.cycle();
  const int64_t rejected_before = play.peer.statuses.back().rejected_messages;
  for (int i = 0; i < 400; ++i) {
    play.send_world();
    for (int n = hostile ? random.index(4) : 0; n > 0; --n, ++transcript.hostile) {
      const auto [channel, bytes] = hostile_message(random, play.utime());
      play.peer.send_bytes(channel, bytes);
    }
    play.answer();
  }
  transcript.commands = play.peer.command_bytes;
  for (controller_status_t& status : play.peer.statuses) {
    transcript.rejected = status.rejected_messages - rejected_before;
    status.cycle_time = 0.0;
    if (hostile) status.rejected_messages = rejected_before;
    status.message = status.message.substr(0, status.message.find("; rejected"));
    transcript.statuses.push_back(test::encoded(status));
  }
  return transcript;
}

void two_runs_are_equal_to_the_byte(void**) {
  for (const char* law : kLaws) {
    const Transcript one = record(law, false), two = record(law, false);
    assert_int_equal(one.commands.size(), 401);
    assert_true(one.commands == two.commands);
    assert_true(one.statuses == two.statuses);
    assert_int_equal(one.rejected, 0);
  }
}

void hostile_messages_are_counted_and_change_nothing(void**) {
  for (const char* law : kLaws) {
    const Transcript undisturbed = record(law, false), hostile = record(law, true);
    assert_true(hostile.hostile > 300);
    assert_int_equal(hostile.rejected, hostile.hostile);
    assert_true(hostile.commands == undisturbed.commands);
    assert_true(hostile.statuses == undisturbed.statuses);
  }
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test_teardown(every_arm_state_is_answered_once_command_first, test::kill_processes),
      cmocka_unit_test_teardown(a_burst_of_arm_states_is_answered_one_by_one, test::kill_processes),
      cmocka_unit_test_teardown(a_repeated_arm_state_is_not_answered_again, test::kill_processes),
      cmocka_unit_test_teardown(a_repeated_arm_state_after_a_pause_is_not_answered_again, test::kill_processes),
      cmocka_unit_test_teardown(the_arm_reaches_the_target, test::kill_processes),
      cmocka_unit_test_teardown(the_arm_rests_while_a_second_controller_runs, test::kill_processes),
      cmocka_unit_test_teardown(two_runs_are_equal_to_the_byte, test::kill_processes),
      cmocka_unit_test_teardown(hostile_messages_are_counted_and_change_nothing, test::kill_processes),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
