#include "firmware/io/blackbox/blackbox.h"

#include <filesystem>
#include <lcm/lcm-cpp.hpp>
#include <map>

#include "firmware/io/lcm/admission.h"
#include "tests/support/allocation_count.h"
#include "tests/support/check.h"
#include "tests/support/lwa3.h"
#include "tests/support/messages.h"
#include "tests/support/replay.h"
#include "tests/support/scratch.h"

using namespace sidestep;
using test::encoded;

namespace {

namespace fs = std::filesystem;

template <typename Message>
void receive(Admission& admission, const test::Bytes& bytes, double now_s, Received<Message>& mail) {
  assert_true(admission.admit(bytes.data(), bytes.size(), now_s, mail.message));
  mail.bytes = bytes;
  mail.received_s = now_s;
  ++mail.count;
}

/// A blackbox, and cycles among some obstacles for it to keep.
struct Flight {
  Config config = load_config("firmware/config/lwa3.yaml", {});
  std::atomic<bool> requested{false};
  std::unique_ptr<Blackbox> blackbox;
  Admission admission{7, config.model.settings};
  Encoder encoder{config.model.arm, config.dialect};
  Received<ArmState> arm;
  Received<Target> target;
  std::unique_ptr<Received<ObstacleSet>> obstacles = std::make_unique<Received<ObstacleSet>>();
  State state;
  ArmState now{0, test::home_rad(), JointVector::Zero(7)};  ///< follows the commands
  Guide guide;                                              ///< followed when it has knots
  std::vector<test::Bytes> statuses;
  int64_t cycles = 0;

  explicit Flight(double seconds) {
    fs::remove_all(test::scratch_folder() + "/logs");
    config.blackbox = {seconds, test::scratch_folder() + "/logs"};
    blackbox = std::make_unique<Blackbox>(config, requested);
  }

  void receive_obstacles(int count) {
    std::vector<obstacle_t> spheres;
    for (int i = 0; i < count; ++i)
      spheres.push_back(test::sphere(i, Vector3(1.0, 0.01 * i, 0.5), 0.05, Vector3::Zero()));
    receive(admission, encoded(test::obstacles_message(cycles + 1, spheres)), 0.01 * cycles, *obstacles);
  }

  void receive_sphere(const Vector3& place_m, int64_t later_us = 0) {
    const obstacle_t sphere = test::sphere(1, place_m, 0.05, Vector3::Zero());
    const int64_t utime = 10000 * (cycles + 1) + later_us;
    receive(admission, encoded(test::obstacles_message(utime, {sphere})), 0.01 * cycles, *obstacles);
  }

  void receive_target() {
    const target_t message = test::target_message(cycles + 1, Vector3(0.1, 0.45, 0.7), Vector3::Zero());
    receive(admission, encoded(message), 0.01 * static_cast<double>(cycles), target);
  }

  void cycle() {
    RecordedCycle kept;
    kept.arguments.seq = ++cycles;
    const double now_s = kept.arguments.now_s = 0.01 * static_cast<double>(cycles);
    const auto arm_state = test::arm_state_message(10000 * cycles, now.position_rad, now.velocity_radps);
    receive(admission, encoded(arm_state), now_s, arm);
    kept.arguments.inputs = {arm.latest(), target.latest(), obstacles->latest(), 0, false};
    kept.arguments.guide = guide;
    if (guide.knots > 0) kept.arguments.inputs.guide = &kept.arguments.guide;
    kept.arguments.state = state;
    const Result result = step(config.model, state, kept.arguments.inputs, now_s);
    state = result.next;
    kept.commanded = result.commanding;
    kept.command = result.command;
    kept.report = result.report;
    if (result.commanding) now = {0, result.command.position_rad, result.command.velocity_radps};
    const Packet status = encoder.encode(kept.report, kept.record);
    statuses.emplace_back(status.bytes, status.bytes + status.size);
    const int64_t before = test::allocation_count();
    blackbox->keep({arm, target, *obstacles}, kept);
    assert_int_equal(test::allocation_count() - before, 0);
  }

  /// Ends the flight; the only log it has left.
  std::string log() {
    requested = true;
    blackbox.reset();
    std::vector<std::string> files;
    for (const auto& entry : fs::directory_iterator(config.blackbox.folder)) files.push_back(entry.path().string());
    assert_int_equal(files.size(), 1);
    return files[0];
  }
};

/// Events of a log by channel, in the order of their first.
struct Events {
  std::map<std::string, int> count;
  std::vector<std::string> order;

  explicit Events(const std::string& file) {
    lcm::LogFile log(file, "r");
    assert_true(log.good());
    while (const lcm::LogEvent* event = log.readNextEvent())
      if (count[event->channel]++ == 0) order.push_back(event->channel);
  }
};

void a_log_holds_every_message_and_cycle_of_its_seconds_in_order(void**) {
  Flight flight(1.0);
  for (int i = 0; i < 250; ++i) {
    if (i % 2 == 0) flight.receive_obstacles(3);
    if (i % 5 == 0) flight.receive_target();
    flight.cycle();
  }
  Events events(flight.log());
  assert_true((events.order == std::vector<std::string>{"BLACKBOX", "ARM_STATE", "TARGET", "OBSTACLES",
                                                        "BLACKBOX_CYCLE", "ARM_COMMAND", "CONTROLLER_STATUS"}));
  check(events.count["BLACKBOX_CYCLE"] >= 100 && events.count["BLACKBOX_CYCLE"] <= 101, "%d cycles",
        events.count["BLACKBOX_CYCLE"]);
  for (const char* each : {"ARM_STATE", "ARM_COMMAND", "CONTROLLER_STATUS"})
    assert_int_equal(events.count[each], events.count["BLACKBOX_CYCLE"]);
  check(events.count["OBSTACLES"] >= 50 && events.count["OBSTACLES"] <= 52, "%d", events.count["OBSTACLES"]);
  check(events.count["TARGET"] >= 20 && events.count["TARGET"] <= 22, "%d", events.count["TARGET"]);
}

/// However long ago: a ring keeps it again before it would be lost, and a log says it once.
void what_was_sent_only_once_is_in_every_log_while_it_is_in_use(void**) {
  for (int length = 3000; length < 6000; length += 500) {
    Flight flight(10.0);
    flight.receive_obstacles(100);
    flight.receive_target();
    for (int i = 0; i < length; ++i) flight.cycle();
    const std::string log = flight.log();
    Events events(log);
    assert_int_equal(events.count["TARGET"], 1);
    assert_int_equal(events.count["OBSTACLES"], 1);
    assert_true(test::agreed(log) >= 1000);
  }
}

/// Before the log and in it, also from a place that no cycle has seen: there the old place counts still.
void a_flight_among_jumping_obstacles_replays_bit_for_bit(void**) {
  for (int length = 200; length < 240; length += 5) {
    Flight flight(1.0);
    for (int i = 0; i < length; ++i) {
      flight.receive_sphere(i < 75 ? Vector3(-0.1, 0.25, 0.8) : Vector3(0.9, 0.9, 0.2));
      if (i % 40 == 0) {
        flight.receive_sphere(Vector3(0.1, 0.25, 0.85), 1000);
        flight.receive_sphere(Vector3(0.9, 0.9, 0.2), 2000);
      }
      flight.receive_target();
      flight.cycle();
    }
    assert_int_equal(static_cast<int>(flight.state.supervision.mode), static_cast<int>(Mode::kTrack));
    assert_true(test::agreed(flight.log()) >= 100);
  }
}

void what_a_log_says_about_guides_is_what_was_said(void**) {
  Flight flight(1.0);
  flight.guide.foresight_status = ForesightStatus::kGuided;
  flight.guide.knots = 1;
  for (int i = 0; i < 200; ++i) {
    flight.receive_obstacles(1);
    flight.receive_target();
    flight.guide.time_s[0] = 0.01 * i + 0.5;
    flight.guide.position_rad[0] = test::home_rad() + JointVector::Constant(7, 0.001 * i);
    flight.cycle();
  }
  const std::vector<test::Bytes> said = flight.statuses;
  lcm::LogFile log(flight.log(), "r");
  size_t at = said.size() - 101;
  int guided = 0;
  while (const lcm::LogEvent* event = log.readNextEvent()) {
    if (event->channel != "CONTROLLER_STATUS") continue;
    const auto* first = static_cast<const uint8_t*>(event->data);
    const test::Bytes logged(first, first + event->datalen);
    while (at < said.size() && guided == 0 && said[at] != logged) ++at;
    check(at < said.size() && said[at] == logged, "status %zu is another one in the log", at);
    ++at;
    ++guided;
  }
  check(guided >= 100, "%d statuses in the log", guided);
}

/// The log reaches back less far instead.
void the_largest_messages_find_room_within_bounds(void**) {
  Flight flight(1.0);
  for (int i = 0; i < 100; ++i) {
    flight.receive_obstacles(kMaxObstacles);
    flight.cycle();
  }
  const std::string log = flight.log();
  Events events(log);
  check(events.count["BLACKBOX_CYCLE"] >= 3, "%d cycles", events.count["BLACKBOX_CYCLE"]);
  assert_int_equal(events.count["OBSTACLES"], events.count["BLACKBOX_CYCLE"]);
  check(fs::file_size(log) < 16u << 20, "%zu bytes", static_cast<size_t>(fs::file_size(log)));
}

void old_logs_give_way_and_other_files_stay(void**) {
  Flight flight(1.0);
  flight.cycle();
  fs::create_directories(flight.config.blackbox.folder);
  for (int i = 0; i < 30; ++i)
    test::scratch_file("logs/blackbox-2020" + std::to_string(1000 + i) + "-fault.lcmlog", "old");
  test::scratch_file("logs/notes.txt", "mine");
  flight.requested = true;
  flight.blackbox.reset();
  size_t logs = 0;
  for (const auto& entry : fs::directory_iterator(flight.config.blackbox.folder))
    logs += entry.path().extension() == ".lcmlog";
  assert_int_equal(logs, 20);
  assert_true(fs::exists(flight.config.blackbox.folder + "/notes.txt"));
  assert_false(fs::exists(flight.config.blackbox.folder + "/blackbox-20201010-fault.lcmlog"));
  assert_true(fs::exists(flight.config.blackbox.folder + "/blackbox-20201011-fault.lcmlog"));
}

void a_full_disk_is_one_clear_line(void**) {
  const RecordRing ring(1000);
  RecordRing::Copy nothing(ring);
  const Config config = load_config("firmware/config/lwa3.yaml", {});
  for (const char* file : {"/dev/full", "/no/such/folder/log"}) {
    const std::string said = test::message_of([&] { write_blackbox_log(file, config, "test", nothing); });
    check(test::one_line_with(said, {file}), "%s: '%s'", file, said.c_str());
  }
}

void a_moment_comes_back_from_its_image_and_a_damaged_image_does_not(void**) {
  StepArguments arguments, back;
  arguments.seq = 5;
  arguments.state.position_rad = test::home_rad();
  StepArgumentsImage image;
  to_image(arguments, image);
  assert_true(from_image(&image, sizeof image, back));
  assert_int_equal(back.seq, 5);
  check_near(back.state.position_rad, test::home_rad(), 0.0);
  assert_false(from_image(&image, sizeof image - 1, back));
  for (size_t at = 0; at < sizeof image; ++at) {
    reinterpret_cast<uint8_t*>(&image)[at] ^= 0x10;
    check(!from_image(&image, sizeof image, back), "byte %zu", at);
    reinterpret_cast<uint8_t*>(&image)[at] ^= 0x10;
  }
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_log_holds_every_message_and_cycle_of_its_seconds_in_order),
      cmocka_unit_test(what_was_sent_only_once_is_in_every_log_while_it_is_in_use),
      cmocka_unit_test(a_flight_among_jumping_obstacles_replays_bit_for_bit),
      cmocka_unit_test(what_a_log_says_about_guides_is_what_was_said),
      cmocka_unit_test(the_largest_messages_find_room_within_bounds),
      cmocka_unit_test(old_logs_give_way_and_other_files_stay),
      cmocka_unit_test(a_full_disk_is_one_clear_line),
      cmocka_unit_test(a_moment_comes_back_from_its_image_and_a_damaged_image_does_not),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
