#include "host/replay/replay.h"

#include <fmt/format.h>

#include <cstring>
#include <lcm/lcm-cpp.hpp>
#include <optional>
#include <sidestep/blackbox_t.hpp>
#include <stdexcept>

#include "firmware/control/input_gate.h"
#include "firmware/io/blackbox/blackbox_log.h"
#include "firmware/io/lcm/message_decoder.h"

namespace sidestep {
namespace {

using Bytes = std::vector<uint8_t>;

Bytes bytes_of(const lcm::LogEvent& event) {
  const auto* first = static_cast<const uint8_t*>(event.data);
  return Bytes(first, first + event.datalen);
}

/// The latest message on a channel, if there was any, and the bytes of the next.
template <typename Message>
struct Held {
  Message message;
  bool any = false;
  Bytes next;
};

/// The cycles of a log, run again one by one.
class Rerun {
 public:
  explicit Rerun(const Config& config)
      : config_(config),
        decoder_(*config.dialect, config.model.arm),
        gate_(std::make_unique<InputGate>(config.model.arm, config.model.settings, InputSource::kRecording)),
        encoder_(config.model.arm, *config.dialect),
        obstacles_(std::make_unique<Held<ObstacleSet>>()) {}

  /// Returns what is wrong with the event, or "".
  std::string take(const lcm::LogEvent& event) {
    const Channels& channels = config_.channels;
    if (event.channel == channels.arm_state) arm_.next = bytes_of(event);
    if (event.channel == channels.target || event.channel == channels.joint_target) target_.next = bytes_of(event);
    if (event.channel == channels.obstacles) obstacles_->next = bytes_of(event);
    if (event.channel == kObstacleValuesChannel) obstacle_values_ = bytes_of(event);
    if (event.channel == kStepArgumentsChannel) return cycle(event);
    if (event.channel == channels.arm_command) compare(bytes_of(event));
    return "";
  }

  Comparison finish() {
    if (expected_) count_difference();
    return found_;
  }

 private:
  std::string cycle(const lcm::LogEvent& event) {
    if (expected_) count_difference();
    StepArguments arguments;
    if (!from_image(event.data, static_cast<size_t>(event.datalen), arguments)) return "a cycle with a wrong checksum";
    Inputs& inputs = arguments.inputs;
    if (!put(arm_, inputs.arm) || !put(target_, inputs.target) || !put(*obstacles_, inputs.obstacles))
      return "a cycle whose messages are missing or invalid";
    if (!put_obstacle_values(obstacles_->message)) return "obstacle values of wrong size";
    if (inputs.guide) inputs.guide = &arguments.guide;
    if (inputs.control.message) inputs.control.message = &arguments.control;
    if (inputs.attachments.message) inputs.attachments.message = &arguments.attachments;
    if (inputs.other_joints.message) inputs.other_joints.message = &arguments.other_joints;
    if (found_.cycles++ == 0) state_ = arguments.state;
    const Result result = step(config_.model, state_, inputs, arguments.now_s);
    state_ = result.next;
    seq_ = arguments.seq;
    // The log shows whether the command was sent: a lockstep loop also sends commands outside a stream.
    answer_.clear();
    if (result.command.position_rad.size() == 0) return "";
    const Packet packet = encoder_.encode(result.command, arguments.utime, arguments.seq);
    answer_ = Bytes(packet.bytes, packet.bytes + packet.size);
    if (result.commanding) expected_ = answer_;
    return "";
  }

  /// The latest message of a channel, as the log has it. Returns false where there is none, or an invalid one.
  template <typename Message>
  bool put(Held<Message>& held, Latest<Message>& latest) {
    if (!latest.message) return true;
    if (!held.next.empty()) held.any = accept({held.next.data(), held.next.size()}, latest.received_s, held.message);
    held.next.clear();
    latest.message = &held.message;
    return held.any;
  }

  template <typename Message>
  bool accept(Packet packet, double received_s, Message& message) {
    return !decoder_.decode(packet, message) && gate_->accept(message, received_s);
  }
  bool accept(Packet packet, double received_s, Target& target) {
    const char* wrong =
        is_joint_target(packet) ? decoder_.decode_joint_target(packet, target) : decoder_.decode(packet, target);
    return !wrong && gate_->accept(target, received_s);
  }
  bool accept(Packet packet, double received_s, ObstacleSet& set) {
    int64_t utime = 0;
    return !decoder_.decode(packet, set, utime) && gate_->accept(set, utime, received_s);
  }

  /// Replaces the set of the message by the one that the cycles used, where the log has it.
  bool put_obstacle_values(ObstacleSet& set) {
    if (obstacle_values_.empty()) return true;
    const size_t count = obstacle_values_.size() / sizeof(Obstacle);
    if (obstacle_values_.size() % sizeof(Obstacle) != 0 || count > kMaxObstacles) return false;
    std::memcpy(static_cast<void*>(set.obstacles.data()), obstacle_values_.data(), obstacle_values_.size());
    set.count = static_cast<int>(count);
    obstacle_values_.clear();
    return true;
  }

  void compare(const Bytes& command) {
    ++found_.commands;
    if (command != answer_) count_difference();
    expected_.reset();
  }

  void count_difference() {
    if (found_.different++ == 0) found_.first_different_seq = seq_;
  }

  const Config& config_;
  MessageDecoder decoder_;
  std::unique_ptr<InputGate> gate_;
  Encoder encoder_;
  Held<ArmState> arm_;
  Held<Target> target_;
  std::unique_ptr<Held<ObstacleSet>> obstacles_;
  Bytes obstacle_values_;
  State state_;
  int64_t seq_ = 0;
  Bytes answer_;                   ///< the command of the cycle last run
  std::optional<Bytes> expected_;  ///< the same, while the log has yet to show it
  Comparison found_;
};

}  // namespace

struct BlackboxLog::Content {
  std::string file;
  lcm::LogFile log;
  blackbox_t header;

  explicit Content(const std::string& the_file) : file(the_file), log(the_file, "r") {}
  [[noreturn]] void fail(const std::string& what) const { throw std::runtime_error(file + ": " + what); }
};

BlackboxLog::BlackboxLog(const std::string& file) : content_(std::make_unique<Content>(file)) {
  if (!content_->log.good()) content_->fail(std::strerror(errno));
  const lcm::LogEvent* event = content_->log.readNextEvent();
  if (!event || event->channel != kBlackboxChannel || content_->header.decode(event->data, 0, event->datalen) < 0)
    content_->fail("is not the log of a blackbox");
  if (content_->header.image_bytes != sizeof(StepArgumentsImage))
    content_->fail("was written by another build of the controller");
}

BlackboxLog::~BlackboxLog() = default;

std::string BlackboxLog::config_file() const {
  return content_->header.config;
}

Overrides BlackboxLog::overrides() const {
  const blackbox_t& header = content_->header;
  return {header.law, header.urdf, header.base, header.tip, header.rate_hz};
}

std::string BlackboxLog::reason() const {
  return content_->header.reason;
}

Comparison BlackboxLog::replay(const Config& config) {
  Rerun rerun(config);
  while (const lcm::LogEvent* event = content_->log.readNextEvent()) {
    const std::string wrong = rerun.take(*event);
    if (!wrong.empty()) content_->fail(fmt::format("damaged: event {}: {}", event->eventnum, wrong));
  }
  const Comparison found = rerun.finish();
  if (found.cycles != content_->header.cycles)
    content_->fail(fmt::format("damaged: holds {} of {} cycles", found.cycles, content_->header.cycles));
  return found;
}

}  // namespace sidestep
