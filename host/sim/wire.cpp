#include "host/sim/wire.h"

#include <poll.h>

#include <algorithm>
#include <deque>
#include <lcm/lcm-cpp.hpp>
#include <sidestep/controller_status_t.hpp>
#include <sidestep/joint_command_t.hpp>
#include <sidestep/joint_state_t.hpp>
#include <sidestep/obstacles_t.hpp>
#include <sidestep/target_t.hpp>
#include <stdexcept>
#include <vector>

namespace sidestep::sim {
namespace {

static_assert(static_cast<int>(Mode::kTrack) == controller_status_t::TRACK);
static_assert(static_cast<int>(Mode::kFault) == controller_status_t::FAULT);
static_assert(static_cast<int>(Shape::kCapsule) == obstacle_t::CAPSULE);
static_assert(static_cast<int>(Shape::kBox) == obstacle_t::BOX);

void copy(const Eigen::Vector3d& from, double (&to)[3]) {
  std::copy_n(from.data(), 3, to);
}

void copy(const Eigen::Quaterniond& from, double (&to)[4]) {
  to[0] = from.w(), to[1] = from.x(), to[2] = from.y(), to[3] = from.z();
}

target_t message_of(const Target& target, int64_t utime) {
  target_t message{};
  message.utime = utime;
  copy(target.motion.position_m, message.position);
  copy(target.motion.velocity_mps, message.velocity);
  message.tracks_orientation = target.tracks_orientation ? 1 : 0;
  copy(target.motion.orientation, message.quaternion);
  copy(target.motion.angular_velocity_radps, message.angular_velocity);
  return message;
}

obstacle_t message_of(const Obstacle& obstacle) {
  obstacle_t message{};
  message.id = obstacle.id;
  message.shape = static_cast<int8_t>(obstacle.solid.shape);
  copy(obstacle.motion.position_m, message.position);
  copy(obstacle.motion.orientation, message.quaternion);
  copy(obstacle.solid.size_m, message.size);
  copy(obstacle.motion.velocity_mps, message.velocity);
  copy(obstacle.motion.angular_velocity_radps, message.angular_velocity);
  return message;
}

obstacles_t message_of(const std::vector<Obstacle>& obstacles, int64_t utime) {
  obstacles_t message;
  message.utime = utime;
  message.num_obstacles = static_cast<int32_t>(obstacles.size());
  for (const Obstacle& obstacle : obstacles) message.obstacles.push_back(message_of(obstacle));
  return message;
}

int64_t int32_at(const uint8_t* bytes, int64_t at) {
  return static_cast<int32_t>(uint32_t{bytes[at]} << 24 | uint32_t{bytes[at + 1]} << 16 | uint32_t{bytes[at + 2]} << 8 |
                              uint32_t{bytes[at + 3]});
}

// The generated decoders believe the counts and lengths they find: the size has to fit them first.
bool has_size_of_command(const uint8_t* bytes, int64_t size) {
  constexpr int64_t kCountAt = 24, kHeader = kCountAt + 4;
  return size >= kHeader && int32_at(bytes, kCountAt) >= 0 && size == kHeader + int32_at(bytes, kCountAt) * 16;
}

bool has_size_of_status(const uint8_t* bytes, int64_t size) {
  constexpr int64_t kLinkAt = 101, kBetweenTexts = 56, kAfterTexts = 201;  // the fixed fields around the two texts
  if (size < kLinkAt + 4) return false;
  const int64_t link = int32_at(bytes, kLinkAt);
  const int64_t message_at = kLinkAt + 4 + link + kBetweenTexts;
  if (link < 1 || size < message_at + 4) return false;
  const int64_t message = int32_at(bytes, message_at);
  return message >= 1 && size == message_at + 4 + message + kAfterTexts;
}

std::optional<Command> decode_command(const uint8_t* bytes, int size) {
  joint_command_t message;
  if (!has_size_of_command(bytes, size) || message.decode(bytes, 0, size) != size) return {};
  Command command{message.utime, Eigen::VectorXd(message.num_joints)};
  std::copy(message.joint_velocity.begin(), message.joint_velocity.end(), command.qd_radps.data());
  return command;
}

std::optional<Status> decode_status(const uint8_t* bytes, int size) {
  controller_status_t message;
  if (!has_size_of_status(bytes, size) || message.decode(bytes, 0, size) != size) return {};
  if (message.mode < controller_status_t::WAIT || message.mode > controller_status_t::FAULT) return {};
  const auto is_control = [](unsigned char c) { return c < 0x20 || c == 0x7f; };
  std::replace_if(message.message.begin(), message.message.end(), is_control, ' ');
  return Status{static_cast<Mode>(message.mode),
                message.cycle_time,
                message.beta,
                message.damping,
                message.skipped_cycles,
                message.rejected_messages,
                message.message,
                message.foresight,
                message.guide_horizon};
}

}  // namespace

struct Bus::Wire {
  // An ear for one arm.
  struct Ear {
    Wire* wire;
    size_t arm;

    void take_command(const lcm::ReceiveBuffer* buffer, const std::string& channel) {
      wire->take(buffer, channel, arm, decode_command);
    }
    void take_status(const lcm::ReceiveBuffer* buffer, const std::string& channel) {
      wire->take(buffer, channel, arm, decode_status);
    }
  };

  Wire(const std::string& url, const std::string& log_file, const std::vector<Channels>& arms)
      : lcm(url), channels(arms) {
    if (!lcm.good()) {
      throw std::runtime_error("--lcm-url: cannot open " + (url.empty() ? "LCM's default" : url) +
                               " (no multicast route?)");
    }
    if (!log_file.empty()) log = std::make_unique<lcm::LogFile>(log_file, "w");
    if (log && !log->good()) throw std::runtime_error(log_file + ": cannot be written");
    for (size_t arm = 0; arm < channels.size(); ++arm) {
      ears.push_back({this, arm});
      Ear& ear = ears.back();
      // A full queue refuses the newest message; this one holds 10 s and is emptied all the time.
      lcm.subscribe(channels[arm].arm_command, &Ear::take_command, &ear)->setQueueCapacity(1000);
      lcm.subscribe(channels[arm].controller_status, &Ear::take_status, &ear)->setQueueCapacity(1000);
    }
  }

  template <typename Decode>
  void take(const lcm::ReceiveBuffer* buffer, const std::string& channel, size_t arm, const Decode& decode) {
    const int size = static_cast<int>(buffer->data_size);
    keep(channel, buffer->data, size);
    if (auto message = decode(static_cast<const uint8_t*>(buffer->data), size)) {
      inbox = Heard{arm, std::move(*message)};
    } else {
      ++malformed;
    }
  }

  template <typename Message>
  void publish(const std::string& channel, const Message& message, int64_t utime) {
    clock_us = utime;
    const int size = message.getEncodedSize();
    bytes.resize(static_cast<size_t>(size));
    message.encode(bytes.data(), 0, size);
    lcm.publish(channel, bytes.data(), static_cast<unsigned>(size));
    keep(channel, bytes.data(), size);
  }

  // Events carry the simulator's clock, not the wall's: the log of a lockstep run plays back at its own pace.
  void keep(const std::string& channel, void* data, int size) {
    if (!log || !log_good) return;
    lcm::LogEvent event;
    event.eventnum = 0;
    event.timestamp = clock_us;
    event.channel = channel;
    event.datalen = size;
    event.data = data;
    log_good = log->writeEvent(&event) == 0;
  }

  lcm::LCM lcm;
  std::vector<Channels> channels;
  std::deque<Ear> ears;  // they stay where they are
  std::unique_ptr<lcm::LogFile> log;
  bool log_good = true;
  int64_t clock_us = 0;  // of the last message sent
  std::vector<uint8_t> bytes;
  std::optional<Heard> inbox;
  int64_t malformed = 0;
};

Bus::Bus(const std::string& url, const std::string& log_file, const std::vector<Channels>& arms)
    : wire_(std::make_unique<Wire>(url, log_file, arms)) {}
Bus::~Bus() = default;

void Bus::publish(size_t arm, const World& world, int64_t utime) {
  publish(arm, world.target, utime);
  publish(arm, world.obstacles, utime);
}

void Bus::publish(size_t arm, const Target& target, int64_t utime) {
  wire_->publish(wire_->channels[arm].target, message_of(target, utime), utime);
}

void Bus::publish(size_t arm, const std::vector<Obstacle>& obstacles, int64_t utime) {
  wire_->publish(wire_->channels[arm].obstacles, message_of(obstacles, utime), utime);
}

void Bus::publish(size_t arm, const JointVector& q_rad, const JointVector& qd_radps, int64_t utime) {
  joint_state_t message;
  message.utime = utime;
  message.num_joints = static_cast<int32_t>(q_rad.size());
  message.joint_position.assign(q_rad.data(), q_rad.data() + q_rad.size());
  message.joint_velocity.assign(qd_radps.data(), qd_radps.data() + qd_radps.size());
  wire_->publish(wire_->channels[arm].arm_state, message, utime);
}

std::optional<Heard> Bus::next(int64_t wait_us) {
  wait_us = std::clamp<int64_t>(wait_us, 0, 100'000);
  const timespec wait{0, static_cast<long>(wait_us * 1000)};
  pollfd readable{wire_->lcm.getFileno(), POLLIN, 0};
  wire_->inbox.reset();
  if (ppoll(&readable, 1, &wait, nullptr) > 0) wire_->lcm.handle();
  return std::move(wire_->inbox);
}

int64_t Bus::malformed() const {
  return wire_->malformed;
}

bool Bus::log_good() const {
  return wire_->log_good;
}

}  // namespace sidestep::sim
