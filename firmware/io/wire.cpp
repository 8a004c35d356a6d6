#include "firmware/io/wire.h"

#include <fmt/format.h>
#include <lcm/lcm.h>

#include <array>
#include <sidestep/controller_status_t.hpp>
#include <sidestep/joint_command_t.hpp>
#include <stdexcept>
#include <vector>

namespace sidestep {
namespace {

// Deep enough that a burst never makes LCM refuse the newest message (a full queue does); receive() drains it.
constexpr int kQueue_messages = 256;
constexpr size_t kLargestOut_bytes = 1024;
constexpr size_t kLongestText = 200;

void call_handler(const lcm_recv_buf_t* buffer, const char*, void* handler) {
  (*static_cast<const ByteHandler*>(handler))(buffer->data, buffer->data_size);
}

void copy(const Vector3& from, double* to) {
  Eigen::Map<Vector3>(to, 3) = from;
}

}  // namespace

struct Wire::Network {
  lcm_t* lcm = nullptr;
  Channels channels;
  std::vector<std::string> shape_links;
  std::array<ByteHandler, 3> handlers;
  joint_command_t command;
  controller_status_t status;
  std::array<uint8_t, kLargestOut_bytes> command_bytes, status_bytes;

  ~Network() {
    if (lcm) lcm_destroy(lcm);
  }

  void subscribe(const std::string& channel, ByteHandler& slot, ByteHandler handler) {
    slot = std::move(handler);
    // A channel is a regular expression to LCM; ours is a name.
    std::string pattern;
    for (char c : channel)
      pattern += std::isalnum(static_cast<unsigned char>(c)) ? std::string(1, c) : fmt::format("[{}]", c);
    lcm_subscription_t* subscription = lcm_subscribe(lcm, pattern.c_str(), call_handler, &slot);
    if (!subscription) throw std::runtime_error(fmt::format("LCM: cannot subscribe to '{}'", channel));
    lcm_subscription_set_queue_capacity(subscription, kQueue_messages);
  }

  template <typename Message, size_t size>
  void send(const std::string& channel, const Message& message, std::array<uint8_t, size>& bytes) {
    const int length = message.encode(bytes.data(), 0, static_cast<int>(size));
    if (length > 0) lcm_publish(lcm, channel.c_str(), bytes.data(), static_cast<unsigned>(length));
  }
};

Wire::Wire(const std::string& url, const Channels& channels, const Arm& arm) : network_(std::make_unique<Network>()) {
  network_->lcm = lcm_create(url.empty() ? nullptr : url.c_str());
  if (!network_->lcm)
    throw std::runtime_error(fmt::format("LCM: cannot use the network '{}' (is there a multicast route?)",
                                         url.empty() ? "LCM's default" : url));
  network_->channels = channels;
  for (const LinkShape& shape : arm.shapes) network_->shape_links.push_back(shape.link.substr(0, kLongestText));
  network_->command.num_joints = arm.joints;
  network_->command.joint_position.resize(static_cast<size_t>(arm.joints));
  network_->command.joint_velocity.resize(static_cast<size_t>(arm.joints));
  network_->status.nearest_link.reserve(kLongestText);
  network_->status.message.reserve(2 * kLongestText);
}

Wire::~Wire() = default;

void Wire::on_arm_state(ByteHandler handler) {
  network_->subscribe(network_->channels.arm_state, network_->handlers[0], std::move(handler));
}
void Wire::on_target(ByteHandler handler) {
  network_->subscribe(network_->channels.target, network_->handlers[1], std::move(handler));
}
void Wire::on_obstacles(ByteHandler handler) {
  network_->subscribe(network_->channels.obstacles, network_->handlers[2], std::move(handler));
}

bool Wire::receive(int timeout_ms) {
  return lcm_handle_timeout(network_->lcm, timeout_ms) > 0;
}

void Wire::publish(const Command& command, int64_t utime, int64_t seq) {
  joint_command_t& message = network_->command;
  message.utime = utime;
  message.seq = seq;
  for (int i = 0; i < message.num_joints; ++i) {
    message.joint_position[static_cast<size_t>(i)] = command.position_rad[i];
    message.joint_velocity[static_cast<size_t>(i)] = command.velocity_radps[i];
  }
  network_->send(network_->channels.arm_command, message, network_->command_bytes);
}

void Wire::publish(const Report& report, const CycleRecord& record) {
  controller_status_t& message = network_->status;
  message.utime = record.utime;
  message.seq = record.seq;
  message.mode = static_cast<int8_t>(report.mode);
  message.fault = static_cast<int32_t>(report.fault);
  message.limiting = report.limiting;
  copy(report.tool_position_m, message.tool_position);
  copy(report.tool_velocity_mps, message.tool_velocity);
  message.target_distance = report.target_distance_m;
  message.clearance = report.clearance_m;
  message.nearest_obstacle = report.nearest_obstacle;
  if (report.nearest_shape >= 0)
    message.nearest_link = network_->shape_links[static_cast<size_t>(report.nearest_shape)];
  else
    message.nearest_link.clear();
  message.beta = report.beta;
  message.damping = report.damping;
  message.shield_correction = report.shield_correction_radps;
  message.cycle_time = record.cycle_time_s;
  message.wake_latency = record.wake_latency_s;
  message.skipped_cycles = record.skipped_cycles;
  message.rejected_messages = record.rejected_messages;
  message.message = report.message;
  if (*record.rejected_reason) message.message.append("; rejected: ").append(record.rejected_reason);
  network_->send(network_->channels.controller_status, message, network_->status_bytes);
}

}  // namespace sidestep
