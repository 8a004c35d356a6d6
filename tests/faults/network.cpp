#include <algorithm>
#include <atomic>
#include <csignal>
#include <memory>
#include <thread>

#include "tests/support/check.h"
#include "tests/support/live_scene.h"
#include "tests/support/lwa3.h"

using namespace sidestep;
using test::Bytes;
using test::check_stream;
using test::LiveArm;
using test::LiveScene;
using test::Process;

namespace {

using Status = controller_status_t;

/// The share of the statuses from `first` on that have this mode.
double share_of(int8_t mode, const LiveArm& arm, size_t first) {
  double count = 0;
  for (size_t i = first; i < arm.peer.statuses.size(); ++i) count += arm.peer.statuses[i].mode == mode;
  return count / static_cast<double>(arm.peer.statuses.size() - first);
}

/// A separate network for the messages to the controller, and a relay that impairs and forwards them by the rule.
struct BadNetwork {
  LiveScene scene{"sidestep"};
  std::string url = test::private_lcm_url(1);

  explicit BadNetwork(const std::string& rule)
      : relay_({"build/relay", "--from", url, "--to", test::private_lcm_url(), "--rule", rule, "--seed", "7"}) {
    scene.arm.run(0.3);  // until the relay receives
    scene.arm.peer.send_to(url);
  }

  /// Ends the impairment. The arm must track within 2 s.
  void heal() {
    relay_.signal(SIGTERM);
    scene.arm.peer.send_to(test::private_lcm_url());
    assert_true(scene.arm.run_until(Status::TRACK, 2.0));
    const int code = relay_.wait(2.0);
    check(code == 0, "the relay's code is %d: %s", code, relay_.output().c_str());
    check(relay_.output().find(" 0 messages") == std::string::npos, "%s", relay_.output().c_str());
  }

 private:
  Process relay_;
};

void lost_messages_never_make_the_commands_jump(void**) {
  for (const auto& [loss, least_tracking] : {std::pair{"0.1", 0.7}, {"0.3", 0.2}, {"0.5", 0.0}}) {
    BadNetwork network(std::string(".*:drop=") + loss);
    const size_t first = network.scene.arm.peer.statuses.size();
    network.scene.wander(3.0);
    const double tracking = share_of(Status::TRACK, network.scene.arm, first);
    print_message("loss %s: tracking in %.0f %% of the cycles\n", loss, 100 * tracking);
    check(tracking >= least_tracking, "loss %s: tracking in %.0f %%", loss, 100 * tracking);
    network.heal();
    check_stream(network.scene.arm);
    test::kill_processes(nullptr);
  }
}

void delayed_messages_never_make_the_commands_jump(void**) {
  for (const char* delay : {"0.005..0.015", "0.005..0.05", "0.05"}) {
    BadNetwork network(std::string(".*:reorder=0.05,duplicate=0.05,delay=") + delay);
    const size_t first = network.scene.arm.peer.statuses.size();
    network.scene.wander(2.4);
    print_message("delay %s: tracking in %.0f %% of the cycles\n", delay,
                  100 * share_of(Status::TRACK, network.scene.arm, first));
    network.heal();
    check_stream(network.scene.arm);
    test::kill_processes(nullptr);
  }
}

/// The relay does not touch the arm states: cycles in which they are too old are the machine's doing.
void corrupted_messages_are_rejected_and_the_others_used(void**) {
  BadNetwork network("(TARGET|OBSTACLES):corrupt=0.3");
  const size_t first = network.scene.arm.peer.statuses.size();
  network.scene.wander(2.0);
  check(network.scene.arm.status().rejected_messages > 20, "%ld", network.scene.arm.status().rejected_messages);
  const auto& statuses = network.scene.arm.peer.statuses;
  const auto late =
      std::count_if(statuses.begin() + static_cast<long>(first), statuses.end(),
                    [](const Status& status) { return status.message.find("arm state") != std::string::npos; });
  const auto count = static_cast<double>(statuses.size() - first);
  const double tracking = share_of(Status::TRACK, network.scene.arm, first) * count;
  check(tracking > 0.7 * (count - static_cast<double>(late)), "%g of %g cycles, %ld late", tracking, count, late);
  network.heal();
  check_stream(network.scene.arm);
}

/// Sends 10 000 messages a second from its own thread.
class Flood {
 public:
  explicit Flood(std::function<void(test::LcmPeer&, int64_t)> send)
      : thread_([this, send = std::move(send)] {
          test::LcmPeer peer;
          using std::chrono::milliseconds, std::chrono::steady_clock;
          for (auto next = steady_clock::now(); !end_;) {
            for (int i = 0; i < 100; ++i, ++sent_) send(peer, sent_);
            // After a pause of the machine few bursts are made up for: more would overflow the test's own socket.
            next = std::max(next + milliseconds(10), steady_clock::now() - milliseconds(20));
            std::this_thread::sleep_until(next);
          }
        }) {}
  ~Flood() {
    end_ = true;
    thread_.join();
  }
  int64_t sent() const { return sent_; }

 private:
  std::atomic<bool> end_{false};
  std::atomic<int64_t> sent_{0};
  std::thread thread_;
};

/// The flood of the current test. It is global because a failed check skips destructors.
std::unique_ptr<Flood> flood;

int end_all(void** state) {
  flood.reset();
  return test::kill_processes(state);
}

/// Checks that few cycles are skipped and tracking continues. The limits allow for other load on the machine.
void check_tracking_continues(LiveScene& scene, const char* what) {
  const Status before = scene.arm.status();
  const size_t first = scene.arm.peer.statuses.size();
  const int64_t sent = flood->sent();
  scene.wander(2.0);
  const Status after = scene.arm.status();
  const double duration_s = static_cast<double>(after.utime - before.utime) * 1e-6;
  const double rate = static_cast<double>(flood->sent() - sent) / duration_s;
  const auto skipped = static_cast<double>(after.skipped_cycles - before.skipped_cycles);
  print_message("%s: %.0f messages/s, %g of %.0f cycles skipped, tracking in %.0f %%\n", what, rate, skipped,
                100 * duration_s, 100 * share_of(Status::TRACK, scene.arm, first));
  check(rate > 4000, "%s: %g messages/s are no flood", what, rate);
  check(skipped < 30 * duration_s, "%s: %g cycles skipped", what, skipped);
  check(share_of(Status::TRACK, scene.arm, first) > 0.5, "%s: %s", what, after.message.c_str());
}

/// The flood fills the receive buffer of the test as well. On a busy machine the test may lose so many commands that it
/// cannot check them; then it repeats the flood.
void check_in_flood(const char* what, const std::function<void(test::LcmPeer&, int64_t)>& send, bool of_obstacles,
                    double least_rejected_share) {
  bool complete = false;
  for (int attempt = 0; attempt < 6 && !complete; ++attempt) {
    LiveScene scene("sidestep");
    scene.arm.sends_obstacles = !of_obstacles;
    flood = std::make_unique<Flood>(send);
    const int64_t rejected = scene.arm.status().rejected_messages, sent = flood->sent();
    check_tracking_continues(scene, what);
    const auto counted = static_cast<double>(scene.arm.status().rejected_messages - rejected);
    check(counted >= least_rejected_share * static_cast<double>(flood->sent() - sent), "%g counted", counted);
    check(scene.arm.commands.violation().empty(), "%s", scene.arm.commands.violation().c_str());
    complete = test::lost_few(scene.arm);
    end_all(nullptr);
  }
  check(complete, "%s: too many commands were lost for a check", what);
}

void a_flood_of_valid_messages_leaves_the_newest_in_use(void**) {
  const auto send = [](test::LcmPeer& peer, int64_t n) {
    peer.send("OBSTACLES",
              test::obstacles_message(n, {test::sphere(5, Vector3(0.9, 0.6, 0.6), 0.05, Vector3::Zero())}));
  };
  check_in_flood("valid", send, true, 0.0);
}

void a_flood_of_invalid_messages_is_counted(void**) {
  const auto send = [bytes = Bytes(80, 3)](test::LcmPeer& peer, int64_t n) mutable {
    bytes[static_cast<size_t>(n % 80)] ^= static_cast<uint8_t>(n);
    peer.send_bytes(n % 2 ? "TARGET" : "ARM_STATE", bytes);
  };
  check_in_flood("invalid", send, false, 0.3);
}

/// The age of a message follows from its time of receipt, not from its utime.
void a_jump_of_the_senders_clock_costs_at_most_a_restart(void**) {
  LiveScene scene("sidestep");
  for (const double jump_s : {3600.0, -3600.0, -0.05, 0.2, -1e6, 1e6}) {
    scene.arm.clock_offset_us += static_cast<int64_t>(jump_s * 1e6);
    scene.wander(0.4);
    check(scene.arm.run_until(Status::TRACK, 2.0), "%g s: %s", jump_s, scene.arm.status().message.c_str());
  }
  check_stream(scene.arm);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test_teardown(lost_messages_never_make_the_commands_jump, end_all),
      cmocka_unit_test_teardown(delayed_messages_never_make_the_commands_jump, end_all),
      cmocka_unit_test_teardown(corrupted_messages_are_rejected_and_the_others_used, end_all),
      cmocka_unit_test_teardown(a_flood_of_valid_messages_leaves_the_newest_in_use, end_all),
      cmocka_unit_test_teardown(a_flood_of_invalid_messages_is_counted, end_all),
      cmocka_unit_test_teardown(a_jump_of_the_senders_clock_costs_at_most_a_restart, end_all),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
