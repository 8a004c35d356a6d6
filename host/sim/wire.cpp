#include "host/sim/wire.h"

#include <poll.h>

#include <algorithm>
#include <deque>
#include <lcm/lcm-cpp.hpp>
#include <sidestep/attachments_t.hpp>
#include <sidestep/controller_status_t.hpp>
#include <sidestep/joint_command_t.hpp>
#include <sidestep/joint_state_t.hpp>
#include <sidestep/joint_target_t.hpp>
#include <sidestep/obstacles_t.hpp>
#include <sidestep/target_t.hpp>
#include <stdexcept>
#include <vector>

#include "firmware/io/lcm/lcm_url.h"
#include "host/sim/clock.h"

namespace sidestep::sim {
namespace {

constexpr int64_t kOthersSilent_us = 1'000'000;  // then no other process sends obstacles any more

static_assert(static_cast<int>(Mode::kWait) == controller_status_t::WAIT);
static_assert(static_cast<int>(Mode::kHold) == controller_status_t::HOLD);
static_assert(static_cast<int>(Mode::kTrack) == controller_status_t::TRACK);
static_assert(static_cast<int>(Mode::kBrake) == controller_status_t::BRAKE);
static_assert(static_cast<int>(Mode::kFault) == controller_status_t::FAULT);
static_assert(static_cast<int>(Shape::kSphere) == obstacle_t::SPHERE);
static_assert(static_cast<int>(Shape::kCapsule) == obstacle_t::CAPSULE);
static_assert(static_cast<int>(Shape::kBox) == obstacle_t::BOX);
static_assert(static_cast<int>(Shape::kCylinder) == obstacle_t::CYLINDER);

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

joint_target_t message_of(const JointVector& joints_rad, int64_t utime) {
  joint_target_t message;
  message.utime = utime;
  message.num_joints = static_cast<int32_t>(joints_rad.size());
  message.joint_position.assign(joints_rad.data(), joints_rad.data() + joints_rad.size());
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
  message.kind = obstacle.is_person ? obstacle_t::PERSON : obstacle_t::THING;
  return message;
}

obstacles_t message_of(const std::vector<Obstacle>& obstacles, int64_t utime) {
  obstacles_t message;
  message.utime = utime;
  message.num_obstacles = static_cast<int32_t>(obstacles.size());
  for (const Obstacle& obstacle : obstacles) message.obstacles.push_back(message_of(obstacle));
  return message;
}

attachments_t message_of(const Grip& grip, int64_t utime) {
  attachments_t message;
  message.utime = utime;
  message.num_shapes = static_cast<int32_t>(grip.held.size());
  for (const Obstacle& held : grip.held) message.shapes.push_back(message_of(held));
  message.num_allowed = static_cast<int32_t>(grip.allowed.size());
  message.allowed = grip.allowed;
  return message;
}

int64_t int32_at(const uint8_t* bytes, int64_t at) {
  return static_cast<int32_t>(uint32_t{bytes[at]} << 24 | uint32_t{bytes[at + 1]} << 16 | uint32_t{bytes[at + 2]} << 8 |
                              uint32_t{bytes[at + 3]});
}

// The generated decoders trust the counts and lengths in a message. They must match its size before it is decoded.

constexpr int64_t kLengthSize = 4;  // of the count of a list or the length of a text

bool has_size_of_command(const uint8_t* bytes, int64_t size) {
  static const int64_t empty_size = joint_command_t{}.getEncodedSize();  // ends with the joint count
  constexpr int64_t kJointSize = 2 * sizeof(double);
  if (size < empty_size) return false;
  const int64_t joints = int32_at(bytes, empty_size - kLengthSize);
  return joints >= 0 && size == empty_size + joints * kJointSize;
}

/// Sizes of the fixed parts of controller_status_t before, between and after its texts, bytes: from the encoding of a
/// status in which all numbers are 0 and each text is one letter.
std::vector<int64_t> sizes_around_texts() {
  constexpr int64_t kHashSize = 8, kTextSize = 2;  // the letter and the terminating zero
  controller_status_t status{};
  status.nearest_link = status.message = status.self_links[0] = status.self_links[1] = "T";
  std::vector<uint8_t> bytes(static_cast<size_t>(status.getEncodedSize()));
  status.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  std::vector<int64_t> sizes;
  auto from = bytes.begin();
  for (auto text = std::find(from + kHashSize, bytes.end(), 'T'); text != bytes.end();
       text = std::find(from, bytes.end(), 'T')) {
    sizes.push_back(text - kLengthSize - from);
    from = text + kTextSize;
  }
  sizes.push_back(bytes.end() - from);
  return sizes;
}

bool has_size_of_status(const uint8_t* bytes, int64_t size) {
  static const std::vector<int64_t> fixed = sizes_around_texts();
  int64_t at = fixed[0];
  for (size_t text = 1; text < fixed.size(); ++text) {
    if (size < at + kLengthSize) return false;
    const int64_t length = int32_at(bytes, at);
    if (length < 1) return false;
    at += kLengthSize + length + fixed[text];
  }
  return size == at;
}

/// LCM delivers the simulator's own messages, too. All of these are the empty set.
bool has_obstacles(const lcm::ReceiveBuffer& buffer) {
  static const auto empty_size = static_cast<uint32_t>(obstacles_t{}.getEncodedSize());
  return buffer.data_size > empty_size;
}

std::optional<Command> decode_command(const uint8_t* bytes, int size) {
  joint_command_t message;
  if (!has_size_of_command(bytes, size) || message.decode(bytes, 0, size) != size) return {};
  Command command{message.utime, message.seq, Eigen::VectorXd(message.num_joints), Eigen::VectorXd(message.num_joints)};
  std::copy(message.joint_velocity.begin(), message.joint_velocity.end(), command.qd_radps.data());
  std::copy(message.joint_position.begin(), message.joint_position.end(), command.q_rad.data());
  return command;
}

std::optional<Status> decode_status(const uint8_t* bytes, int size) {
  controller_status_t message;
  if (!has_size_of_status(bytes, size) || message.decode(bytes, 0, size) != size) return {};
  if (message.mode < controller_status_t::WAIT || message.mode > controller_status_t::FAULT) return {};
  const auto is_control = [](unsigned char c) { return c < 0x20 || c == 0x7f; };
  std::replace_if(message.message.begin(), message.message.end(), is_control, ' ');
  Status status{static_cast<Mode>(message.mode),
                message.cycle_time,
                message.beta,
                message.damping,
                message.skipped_cycles,
                message.rejected_messages,
                message.message,
                message.foresight,
                message.guide_horizon};
  status.guide_tool_m = Eigen::Map<const Eigen::Matrix<double, 3, 8>>(&message.guide_tool[0][0]);
  return status;
}

}  // namespace

struct SimWire::Network {
  /// The channels of one arm's controller.
  struct Subscription {
    Network* network;
    size_t arm;
    int64_t obstacles_heard_us = -kOthersSilent_us;  ///< from another process, on the monotonic clock

    void on_command(const lcm::ReceiveBuffer* buffer, const std::string& channel) {
      network->receive(buffer, channel, arm, decode_command);
    }
    void on_status(const lcm::ReceiveBuffer* buffer, const std::string& channel) {
      network->receive(buffer, channel, arm, decode_status);
    }
    void on_target_of_others(const lcm::ReceiveBuffer* buffer, const std::string& channel) {
      network->write_log(channel, buffer->data, static_cast<int>(buffer->data_size));
    }
    void on_obstacles(const lcm::ReceiveBuffer* buffer, const std::string& channel) {
      if (!has_obstacles(*buffer)) return;
      obstacles_heard_us = monotonic_us();
      network->write_log(channel, buffer->data, static_cast<int>(buffer->data_size));
    }
  };

  Network(const std::string& url, const std::string& log_file, const std::vector<Channels>& arms)
      : lcm(url), channels(arms) {
    if (!lcm.good())
      throw std::runtime_error("LCM network " + lcm_url_or_default(url) + ": cannot be used (no multicast route?)");
    if (!log_file.empty()) log = std::make_unique<lcm::LogFile>(log_file, "w");
    if (log && !log->good()) throw std::runtime_error(log_file + ": cannot be written");
    for (size_t arm = 0; arm < channels.size(); ++arm) {
      subscriptions.push_back({this, arm});
      Subscription& subscription = subscriptions.back();
      // LCM drops the newest message when a queue is full. This one holds 10 s of messages.
      constexpr int kQueueCapacity = 1000;
      lcm.subscribe(channels[arm].arm_command, &Subscription::on_command, &subscription)
          ->setQueueCapacity(kQueueCapacity);
      lcm.subscribe(channels[arm].controller_status, &Subscription::on_status, &subscription)
          ->setQueueCapacity(kQueueCapacity);
    }
  }

  void leave_to_others(size_t arm, const World& world) {
    Subscription& subscription = subscriptions[arm];
    if (!world.target) {
      for (const std::string& channel : {channels[arm].target, channels[arm].joint_target})
        lcm.subscribe(channel, &Subscription::on_target_of_others, &subscription);
    }
    if (world.obstacles_from_others) lcm.subscribe(channels[arm].obstacles, &Subscription::on_obstacles, &subscription);
  }

  bool others_send_obstacles(size_t arm) const {
    return monotonic_us() - subscriptions[arm].obstacles_heard_us < kOthersSilent_us;
  }

  template <typename Decode>
  void receive(const lcm::ReceiveBuffer* buffer, const std::string& channel, size_t arm, const Decode& decode) {
    const int size = static_cast<int>(buffer->data_size);
    write_log(channel, buffer->data, size);
    if (auto message = decode(static_cast<const uint8_t*>(buffer->data), size)) {
      received = ReceivedMessage{arm, std::move(*message)};
    } else {
      ++malformed;
    }
  }

  template <typename Message>
  void publish(const std::string& channel, const Message& message, int64_t utime) {
    if (clock_us > 0 && utime - clock_us > kJump_us) jumped_us += utime - clock_us;
    clock_us = utime;
    const int size = message.getEncodedSize();
    bytes.resize(static_cast<size_t>(size));
    message.encode(bytes.data(), 0, size);
    lcm.publish(channel, bytes.data(), static_cast<unsigned>(size));
    write_log(channel, bytes.data(), size);
  }

  // Time stamps are of the simulator's clock, so that a player plays the log of a lockstep run at the speed of the arm,
  // and does not wait where this clock jumps to the start of the run (lockstep.cpp).
  void write_log(const std::string& channel, void* data, int size) {
    if (!log || !log_good) return;
    lcm::LogEvent event;
    event.eventnum = 0;
    event.timestamp = clock_us - jumped_us;
    event.channel = channel;
    event.datalen = size;
    event.data = data;
    log_good = log->writeEvent(&event) == 0;
  }

  lcm::LCM lcm;
  std::vector<Channels> channels;
  std::deque<Subscription> subscriptions;  ///< a deque: LCM keeps their addresses
  std::unique_ptr<lcm::LogFile> log;
  bool log_good = true;
  static constexpr int64_t kJump_us = 10'000'000;
  int64_t clock_us = 0;   ///< utime of the last message sent
  int64_t jumped_us = 0;  ///< sum of its jumps
  std::vector<uint8_t> bytes;
  std::optional<ReceivedMessage> received;  ///< by the last lcm.handle()
  int64_t malformed = 0;
};

SimWire::SimWire(const std::string& url, const std::string& log_file, const std::vector<Channels>& arms)
    : network_(std::make_unique<Network>(url, log_file, arms)) {}
SimWire::~SimWire() = default;

void SimWire::leave_to_others(size_t arm, const World& world) {
  network_->leave_to_others(arm, world);
}

void SimWire::publish(size_t arm, const World& world, int64_t utime) {
  if (world.target) publish(arm, *world.target, utime);
  publish(arm, world.obstacles, utime);
  if (world.grip) publish(arm, *world.grip, utime);
}

void SimWire::publish(size_t arm, const Target& target, int64_t utime) {
  const Channels& channels = network_->channels[arm];
  if (target.joints_rad.size() > 0)
    network_->publish(channels.joint_target, message_of(target.joints_rad, utime), utime);
  else
    network_->publish(channels.target, message_of(target, utime), utime);
}

void SimWire::publish(size_t arm, const std::vector<Obstacle>& obstacles, int64_t utime) {
  if (network_->others_send_obstacles(arm)) return;
  network_->publish(network_->channels[arm].obstacles, message_of(obstacles, utime), utime);
}

void SimWire::publish(size_t arm, const Grip& grip, int64_t utime) {
  network_->publish(network_->channels[arm].attachments, message_of(grip, utime), utime);
}

void SimWire::publish(size_t arm, const JointVector& q_rad, const JointVector& qd_radps, int64_t utime) {
  joint_state_t message;
  message.utime = utime;
  message.num_joints = static_cast<int32_t>(q_rad.size());
  message.joint_position.assign(q_rad.data(), q_rad.data() + q_rad.size());
  message.joint_velocity.assign(qd_radps.data(), qd_radps.data() + qd_radps.size());
  network_->publish(network_->channels[arm].arm_state, message, utime);
}

std::optional<ReceivedMessage> SimWire::next(int64_t wait_us) {
  wait_us = std::clamp<int64_t>(wait_us, 0, 100'000);
  const timespec wait{0, static_cast<long>(wait_us * 1000)};
  pollfd readable{network_->lcm.getFileno(), POLLIN, 0};
  network_->received.reset();
  if (ppoll(&readable, 1, &wait, nullptr) > 0) network_->lcm.handle();
  return std::move(network_->received);
}

int64_t SimWire::malformed() const {
  return network_->malformed;
}

bool SimWire::log_good() const {
  return network_->log_good;
}

}  // namespace sidestep::sim
