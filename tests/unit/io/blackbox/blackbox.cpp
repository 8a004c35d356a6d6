#include "firmware/io/blackbox/blackbox.h"

#include <sys/file.h>

#include <filesystem>
#include <lcm/lcm-cpp.hpp>
#include <map>

#include "firmware/io/lcm/network_inputs.h"
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

bool receive(NetworkInputs& inputs, Packet packet, double now_s, Received<ObstacleSet>& received) {
  return inputs.receive_obstacles(0, packet, now_s, received);
}
template <typename Message>
bool receive(NetworkInputs& inputs, Packet packet, double now_s, Received<Message>& received) {
  return inputs.receive(packet, now_s, received);
}
template <typename Message>
void receive(NetworkInputs& inputs, const test::Bytes& bytes, double now_s, Received<Message>& received) {
  assert_true(receive(inputs, Packet{bytes.data(), bytes.size()}, now_s, received));
  ++received.count;
}

/// A blackbox and the control cycles that it records.
struct RecordedRun {
  Config config = load_config("firmware/config/lwa3.yaml", {});
  std::atomic<bool> requested{false};
  std::unique_ptr<Blackbox> blackbox;
  NetworkInputs inputs{config.model.settings, config.model.arm, *config.dialect, {}, false};
  Encoder encoder{config.model.arm, *config.dialect};
  Received<ArmState> arm;
  Received<Target> target;
  Received<OtherJoints> other_joints;
  Received<Control> control;
  Received<Attachments> attachments;
  std::unique_ptr<Received<ObstacleSet>> obstacles = std::make_unique<Received<ObstacleSet>>();
  State state;
  ArmState now{0, test::home_rad(), JointVector::Zero(7)};  ///< follows the commands
  Guide guide;                                              ///< followed when it has knots
  std::vector<test::Bytes> statuses;
  int64_t cycles = 0;

  explicit RecordedRun(double seconds) {
    fs::remove_all(test::scratch_folder() + "/logs");
    config.blackbox = {seconds, test::scratch_folder() + "/logs"};
    blackbox = std::make_unique<Blackbox>(config, requested);
  }

  void receive_obstacles(int count) {
    std::vector<obstacle_t> spheres;
    for (int i = 0; i < count; ++i)
      spheres.push_back(test::sphere(i, Vector3(1.0, 0.01 * i, 0.5), 0.05, Vector3::Zero()));
    receive(inputs, encoded(test::obstacles_message(cycles + 1, spheres)), 0.01 * cycles, *obstacles);
  }

  void receive_sphere(const Vector3& centre_m, int64_t later_us = 0) {
    const obstacle_t sphere = test::sphere(1, centre_m, 0.05, Vector3::Zero());
    const int64_t utime = 10000 * (cycles + 1) + later_us;
    receive(inputs, encoded(test::obstacles_message(utime, {sphere})), 0.01 * cycles, *obstacles);
  }

  void receive_target() {
    const target_t message = test::target_message(cycles + 1, Vector3(0.1, 0.45, 0.7), Vector3::Zero());
    receive(inputs, encoded(message), 0.01 * static_cast<double>(cycles), target);
  }

  void receive_joint_target() {
    const test::Bytes bytes = encoded(test::joint_target_message(cycles + 1, JointVector::Constant(7, 0.4)));
    assert_true(inputs.receive_joint_target({bytes.data(), bytes.size()}, 0.01 * static_cast<double>(cycles), target));
    ++target.count;
  }

  void cycle() {
    RecordedCycle recorded;
    recorded.arguments.seq = ++cycles;
    const double now_s = recorded.arguments.now_s = 0.01 * static_cast<double>(cycles);
    const auto arm_state = test::arm_state_message(10000 * cycles, now.position_rad, now.velocity_radps);
    receive(inputs, encoded(arm_state), now_s, arm);
    recorded.arguments.inputs = {arm.latest(), target.latest(), obstacles->latest(), 0, false};
    recorded.arguments.guide = guide;
    if (guide.knots > 0) recorded.arguments.inputs.guide = &recorded.arguments.guide;
    recorded.arguments.state = state;
    const Result result = step(config.model, state, recorded.arguments.inputs, now_s);
    state = result.next;
    recorded.commanded = result.commanding;
    recorded.command = result.command;
    recorded.report = result.report;
    if (result.commanding) now = {0, result.command.position_rad, result.command.velocity_radps};
    const Packet status = encoder.encode(recorded.report, recorded.record);
    statuses.emplace_back(status.bytes, status.bytes + status.size);
    const int64_t before = test::allocation_count();
    blackbox->record({arm, target, *obstacles, other_joints, control, attachments}, recorded);
    assert_int_equal(test::allocation_count() - before, 0);
  }

  /// Ends the run and returns the path of its only log.
  std::string log() {
    requested = true;
    blackbox.reset();
    std::vector<std::string> files;
    for (const auto& entry : fs::directory_iterator(config.blackbox.folder)) files.push_back(entry.path().string());
    assert_int_equal(files.size(), 1);
    return files[0];
  }
};

/// Number of a log's events by channel; the channels in the order of their first events.
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
  RecordedRun run(1.0);
  for (int i = 0; i < 250; ++i) {
    if (i % 2 == 0) run.receive_obstacles(3);
    if (i % 5 == 0) run.receive_target();
    run.cycle();
  }
  Events events(run.log());
  assert_true((events.order == std::vector<std::string>{"BLACKBOX", "ARM_STATE", "TARGET", "OBSTACLES",
                                                        "BLACKBOX_CYCLE", "ARM_COMMAND", "CONTROLLER_STATUS"}));
  check(events.count["BLACKBOX_CYCLE"] >= 100 && events.count["BLACKBOX_CYCLE"] <= 101, "%d cycles",
        events.count["BLACKBOX_CYCLE"]);
  for (const char* each : {"ARM_STATE", "ARM_COMMAND", "CONTROLLER_STATUS"})
    assert_int_equal(events.count[each], events.count["BLACKBOX_CYCLE"]);
  check(events.count["OBSTACLES"] >= 50 && events.count["OBSTACLES"] <= 52, "%d", events.count["OBSTACLES"]);
  check(events.count["TARGET"] >= 20 && events.count["TARGET"] <= 22, "%d", events.count["TARGET"]);
}

/// The ring stores such a message again before it is overwritten; a log contains it once.
void a_message_in_use_is_in_every_log_even_when_sent_only_once(void**) {
  for (int length = 3000; length < 6000; length += 500) {
    RecordedRun run(10.0);
    run.receive_obstacles(100);
    run.receive_target();
    for (int i = 0; i < length; ++i) run.cycle();
    const std::string log = run.log();
    Events events(log);
    assert_int_equal(events.count["TARGET"], 1);
    assert_int_equal(events.count["OBSTACLES"], 1);
    assert_true(test::agreeing_cycles(log) >= 1000);
  }
}

void a_run_that_switches_between_postures_and_positions_replays_bit_for_bit(void**) {
  for (int length = 200; length < 240; length += 5) {
    RecordedRun run(1.0);
    for (int i = 0; i < length; ++i) {
      run.receive_obstacles(1);
      if (i % 3 == 0) i / 30 % 2 ? run.receive_target() : run.receive_joint_target();
      run.cycle();
    }
    assert_int_equal(static_cast<int>(run.state.supervision.mode), static_cast<int>(Mode::kTrack));
    const std::string log = run.log();
    assert_true(test::agreeing_cycles(log) >= 100);
    Events events(log);
    check(events.count["TARGET"] > 10 && events.count["JOINT_TARGET"] > 10, "%d and %d", events.count["TARGET"],
          events.count["JOINT_TARGET"]);
  }
}

/// The obstacle jumps before the log begins and within it, also from positions received between two cycles.
void a_run_among_jumping_obstacles_replays_bit_for_bit(void**) {
  for (int length = 200; length < 240; length += 5) {
    RecordedRun run(1.0);
    for (int i = 0; i < length; ++i) {
      run.receive_sphere(i < 75 ? Vector3(-0.1, 0.25, 0.8) : Vector3(0.9, 0.9, 0.2));
      if (i % 40 == 0) {
        run.receive_sphere(Vector3(0.1, 0.25, 0.85), 1000);
        run.receive_sphere(Vector3(0.9, 0.9, 0.2), 2000);
      }
      run.receive_target();
      run.cycle();
    }
    assert_int_equal(static_cast<int>(run.state.supervision.mode), static_cast<int>(Mode::kTrack));
    assert_true(test::agreeing_cycles(run.log()) >= 100);
  }
}

void the_statuses_in_a_log_equal_those_published_with_a_guide(void**) {
  RecordedRun run(1.0);
  run.guide.foresight_status = ForesightStatus::kGuided;
  run.guide.add(0.0, test::home_rad());
  for (int i = 0; i < 200; ++i) {
    run.receive_obstacles(1);
    run.receive_target();
    run.guide.time_s[0] = 0.01 * i + 0.5;
    run.guide.position_rad[0] = test::home_rad() + JointVector::Constant(7, 0.001 * i);
    run.cycle();
  }
  const std::vector<test::Bytes> published = run.statuses;
  lcm::LogFile log(run.log(), "r");
  size_t at = published.size() - 101;
  int compared = 0;
  while (const lcm::LogEvent* event = log.readNextEvent()) {
    if (event->channel != "CONTROLLER_STATUS") continue;
    const auto* first = static_cast<const uint8_t*>(event->data);
    const test::Bytes logged(first, first + event->datalen);
    while (at < published.size() && compared == 0 && published[at] != logged) ++at;
    check(at < published.size() && published[at] == logged, "status %zu differs in the log", at);
    ++at;
    ++compared;
  }
  check(compared >= 100, "%d statuses in the log", compared);
}

/// The log covers a shorter time instead.
void the_largest_messages_fit_into_a_bounded_log(void**) {
  RecordedRun run(1.0);
  for (int i = 0; i < 100; ++i) {
    run.receive_obstacles(kMaxObstacles);
    run.cycle();
  }
  const std::string log = run.log();
  Events events(log);
  check(events.count["BLACKBOX_CYCLE"] >= 3, "%d cycles", events.count["BLACKBOX_CYCLE"]);
  assert_int_equal(events.count["OBSTACLES"], events.count["BLACKBOX_CYCLE"]);
  check(fs::file_size(log) < 16u << 20, "%zu bytes", static_cast<size_t>(fs::file_size(log)));
}

/// The newest 10 of each reason are kept.
void requested_logs_do_not_remove_a_log_of_a_fault(void**) {
  RecordedRun run(1.0);
  run.cycle();
  fs::create_directories(run.config.blackbox.folder);
  const auto exists = [&](const std::string& name) { return fs::exists(run.config.blackbox.folder + "/" + name); };
  test::scratch_file("logs/blackbox-20200101-fault.lcmlog", "old");
  for (int i = 0; i < 30; ++i)
    test::scratch_file("logs/blackbox-2020" + std::to_string(1000 + i) + "-request.lcmlog", "old");
  test::scratch_file("logs/notes.txt", "mine");
  run.requested = true;
  run.blackbox.reset();
  size_t logs = 0;
  for (const auto& entry : fs::directory_iterator(run.config.blackbox.folder))
    logs += entry.path().extension() == ".lcmlog";
  assert_int_equal(logs, 11);
  assert_true(exists("notes.txt") && exists("blackbox-20200101-fault.lcmlog"));
  assert_false(exists("blackbox-20201020-request.lcmlog"));
  assert_true(exists("blackbox-20201021-request.lcmlog"));
}

void an_unfinished_log_of_a_killed_process_is_removed_at_the_start(void**) {
  RecordedRun run(1.0);
  run.blackbox.reset();
  fs::create_directories(run.config.blackbox.folder);
  const std::string unfinished = test::scratch_file("logs/blackbox-20200101-fault.lcmlog.part", "killed");
  const std::string other = test::scratch_file("logs/other.part", "mine");
  const std::string written = test::scratch_file("logs/blackbox-20200102-fault.lcmlog.part", "");
  lcm::LogFile in_use(written, "w");
  flock(fileno(in_use.getFilePtr()), LOCK_EX);  // as a controller that writes it
  run.blackbox = std::make_unique<Blackbox>(run.config, run.requested);
  run.blackbox.reset();
  assert_false(fs::exists(unfinished));
  assert_true(fs::exists(other) && fs::exists(written));
}

void a_full_disk_is_reported_in_one_line(void**) {
  const RecordRing ring(1000);
  RecordRing::Copy nothing(ring);
  const Config config = load_config("firmware/config/lwa3.yaml", {});
  for (const char* file : {"/dev/full", "/no/such/folder/log"}) {
    const std::string message = test::message_of([&] { write_blackbox_log(file, config, "test", nothing); });
    check(test::one_line_with(message, {file}), "%s: '%s'", file, message.c_str());
  }
}

void step_arguments_are_restored_from_their_image_but_not_from_a_damaged_one(void**) {
  StepArguments arguments, back;
  arguments.seq = 5;
  arguments.state.stream.position_rad = test::home_rad();
  StepArgumentsImage image;
  to_image(arguments, image);
  assert_true(from_image(&image, sizeof image, back));
  assert_int_equal(back.seq, 5);
  check_near(back.state.stream.position_rad, test::home_rad(), 0.0);
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
      cmocka_unit_test(a_message_in_use_is_in_every_log_even_when_sent_only_once),
      cmocka_unit_test(a_run_that_switches_between_postures_and_positions_replays_bit_for_bit),
      cmocka_unit_test(a_run_among_jumping_obstacles_replays_bit_for_bit),
      cmocka_unit_test(the_statuses_in_a_log_equal_those_published_with_a_guide),
      cmocka_unit_test(the_largest_messages_fit_into_a_bounded_log),
      cmocka_unit_test(requested_logs_do_not_remove_a_log_of_a_fault),
      cmocka_unit_test(an_unfinished_log_of_a_killed_process_is_removed_at_the_start),
      cmocka_unit_test(a_full_disk_is_reported_in_one_line),
      cmocka_unit_test(step_arguments_are_restored_from_their_image_but_not_from_a_damaged_one),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
