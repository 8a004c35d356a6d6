#include "firmware/io/blackbox/blackbox_log.h"

#include <fmt/format.h>
#include <sys/file.h>

#include <array>
#include <cmath>
#include <cstring>
#include <lcm/lcm-cpp.hpp>
#include <sidestep/blackbox_t.hpp>
#include <stdexcept>

#include "firmware/base/realtime.h"
#include "firmware/io/lcm/message_decoder.h"
#include "firmware/io/lcm/obstacle_encoder.h"

namespace sidestep {
namespace {

using Record = RecordRing::Copy::Record;
using Messages = std::array<Record, kMessageKinds>;

/// Calls use(cycle, messages) for every cycle since since_s whose messages are all in the ring. `messages` are those
/// received after the previous cycle; the others are empty.
template <typename Use>
void for_each_cycle(RecordRing::Copy& records, double since_s, Use&& use) {
  Messages messages;
  std::array<bool, kMessageKinds> seen{};
  const auto lacks = [&seen](const auto& latest, RecordKind kind) {
    return latest.message && !seen[static_cast<size_t>(kind)];
  };
  Record record;
  for (records.rewind(); records.next(record);) {
    if (record.kind != static_cast<uint8_t>(RecordKind::kCycle)) {
      messages[record.kind] = record;
      if (record.kind == static_cast<uint8_t>(RecordKind::kObstacles))
        messages[static_cast<size_t>(RecordKind::kObstacleValues)] = {};
      seen[record.kind] = true;
      continue;
    }
    RecordedCycle cycle;
    std::memcpy(static_cast<void*>(&cycle), record.bytes, sizeof cycle);
    if (cycle.report.guide) cycle.report.guide = &cycle.arguments.guide;  // the recorded pointer is not valid
    const Inputs& inputs = cycle.arguments.inputs;
    if (cycle.arguments.now_s < since_s || lacks(inputs.arm, RecordKind::kArmState) ||
        lacks(inputs.target, RecordKind::kTarget) || lacks(inputs.obstacles, RecordKind::kObstacles))
      continue;
    use(cycle, messages);
    messages = {};
  }
}

class Log {
 public:
  Log(const std::string& file, const Config& config, double newest_s)
      : file_(file),
        log_(file, "w"),
        channels_(config.channels),
        encoder_(config.model.arm, *config.dialect),
        epoch_s_(wall_s() - newest_s) {
    if (!log_.good()) throw std::runtime_error(fmt::format("{}: {}", file, std::strerror(errno)));
    flock(fileno(log_.getFilePtr()), LOCK_EX | LOCK_NB);  // while it is being written (blackbox.cpp)
  }

  void write(const std::string& channel, double at_s, const Packet& packet) {
    lcm::LogEvent event{0, static_cast<int64_t>((epoch_s_ + at_s) * 1e6), channel, static_cast<int32_t>(packet.size),
                        const_cast<uint8_t*>(packet.bytes)};
    if (log_.writeEvent(&event) != 0) fail();
  }

  void write(const RecordedCycle& cycle, const Messages& messages) {
    const StepArguments& arguments = cycle.arguments;
    write_new(channels_.arm_state, arguments.inputs.arm, messages, RecordKind::kArmState);
    const Record& target = messages[static_cast<size_t>(RecordKind::kTarget)];
    write_new(is_joint_target({target.bytes, target.size}) ? channels_.joint_target : channels_.target,
              arguments.inputs.target, messages, RecordKind::kTarget);
    write_obstacles(arguments.inputs.obstacles, messages);
    write_if_any(channels_.other_joints, arguments.inputs.other_joints, messages, RecordKind::kOtherJoints);
    write_if_any(channels_.control, arguments.inputs.control, messages, RecordKind::kControl);
    write_if_any(channels_.attachments, arguments.inputs.attachments, messages, RecordKind::kAttachments);
    StepArgumentsImage image;
    to_image(arguments, image);
    write(kStepArgumentsChannel, arguments.now_s, Packet{reinterpret_cast<const uint8_t*>(&image), sizeof image});
    if (cycle.commanded)
      write(channels_.arm_command, arguments.now_s, encoder_.encode(cycle.command, arguments.utime, arguments.seq));
    write(channels_.controller_status, arguments.now_s, encoder_.encode(cycle.report, cycle.record));
  }

  void finish() {
    if (std::fflush(log_.getFilePtr()) != 0) fail();
  }

 private:
  /// Of a set that was merged from several senders there is no message: it is encoded for the readers of the log.
  void write_obstacles(const Latest<ObstacleSet>& latest, const Messages& messages) {
    if (!take_new(latest, RecordKind::kObstacles)) return;
    const Record& message = messages[static_cast<size_t>(RecordKind::kObstacles)];
    const Record& values = messages[static_cast<size_t>(RecordKind::kObstacleValues)];
    const bool merged = message.size == 0;
    write(channels_.obstacles, latest.received_s,
          merged ? encode_values(values, latest.received_s) : Packet{message.bytes, message.size});
    if (values.size > 0) write(kObstacleValuesChannel, latest.received_s, Packet{values.bytes, values.size});
  }

  Packet encode_values(const Record& values, double received_s) {
    obstacle_encoder_.begin(static_cast<int64_t>(received_s * 1e6));
    for (size_t at = 0; at + sizeof(Obstacle) <= values.size; at += sizeof(Obstacle)) {
      Obstacle obstacle;
      std::memcpy(static_cast<void*>(&obstacle), values.bytes + at, sizeof obstacle);
      obstacle_encoder_.add(obstacle);
    }
    return obstacle_encoder_.finish();
  }

  /// Whether the message has not been written yet; a message in use for long stands in the ring repeatedly, in the log
  /// once. It then counts as written.
  template <typename Message>
  bool take_new(const Latest<Message>& latest, RecordKind kind) {
    int64_t& written = written_[static_cast<size_t>(kind)];
    if (latest.count == written) return false;
    written = latest.count;
    return true;
  }

  template <typename Message>
  void write_new(const std::string& channel, const Latest<Message>& latest, const Messages& messages, RecordKind kind) {
    if (!take_new(latest, kind)) return;
    const Record& message = messages[static_cast<size_t>(kind)];
    write(channel, latest.received_s, Packet{message.bytes, message.size});
  }

  /// Of a kind that need not have been sent.
  template <typename Message>
  void write_if_any(const std::string& channel, const Latest<Message>& latest, const Messages& messages,
                    RecordKind kind) {
    if (messages[static_cast<size_t>(kind)].size > 0) write_new(channel, latest, messages, kind);
  }

  [[noreturn]] void fail() { throw std::runtime_error(fmt::format("{}: {}", file_, std::strerror(errno))); }

  std::string file_;
  lcm::LogFile log_;
  Channels channels_;
  Encoder encoder_;
  ObstacleEncoder obstacle_encoder_{kMaxObstacles};
  double epoch_s_;
  std::array<int64_t, kMessageKinds> written_{};  ///< counts of the messages last written
};

std::vector<uint8_t> header(const Config& config, const std::string& reason, int64_t utime, int64_t cycles) {
  blackbox_t message;
  message.utime = utime;
  message.reason = reason;
  message.config = config.file;
  message.law = config.overrides.law;
  message.urdf = config.overrides.urdf;
  message.base = config.overrides.base;
  message.tip = config.overrides.tip;
  message.rate_hz = config.overrides.rate_hz;
  message.cycles = cycles;
  message.image_bytes = sizeof(StepArgumentsImage);
  std::vector<uint8_t> bytes(static_cast<size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

}  // namespace

int64_t write_blackbox_log(const std::string& file, const Config& config, const std::string& reason,
                           RecordRing::Copy& records) {
  StepArguments newest;
  for_each_cycle(records, -HUGE_VAL, [&](const RecordedCycle& cycle, const Messages&) { newest = cycle.arguments; });
  const double since_s = newest.now_s - config.blackbox.seconds;
  int64_t cycles = 0;
  for_each_cycle(records, since_s, [&](const RecordedCycle&, const Messages&) { ++cycles; });

  Log log(file, config, newest.now_s);
  const std::vector<uint8_t> first = header(config, reason, newest.utime, cycles);
  log.write(kBlackboxChannel, newest.now_s, Packet{first.data(), first.size()});
  for_each_cycle(records, since_s,
                 [&](const RecordedCycle& cycle, const Messages& messages) { log.write(cycle, messages); });
  log.finish();
  return cycles;
}

}  // namespace sidestep
