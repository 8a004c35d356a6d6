#include "firmware/io/lcm/wire.h"

#include <fmt/format.h>
#include <lcm/lcm.h>

#include <deque>
#include <stdexcept>

#include "firmware/io/lcm/link_encoder.h"
#include "firmware/io/lcm/message_bytes.h"
#include "firmware/io/lcm/sent_messages.h"

namespace sidestep {
namespace {

// A full queue refuses the newest message; this one is deep enough for a burst, and receive() drains it.
constexpr int kQueueMessages = 256;

void call_handler(const lcm_recv_buf_t* buffer, const char*, void* handler) {
  (*static_cast<const PacketHandler*>(handler))({static_cast<const uint8_t*>(buffer->data), buffer->data_size});
}

}  // namespace

struct Wire::Network {
  lcm_t* lcm = nullptr;
  Channels channels;
  Neighbours neighbours;
  std::deque<PacketHandler> handlers;  // a deque keeps their addresses
  SentMessages sent_commands;
  Encoder encoder;
  LinkEncoder link_encoder;

  explicit Network(const WireSetup& setup)
      : channels(setup.channels),
        neighbours(setup.neighbours),
        encoder(setup.arm, setup.dialect),
        link_encoder(setup.arm, setup.neighbours.world_from_base) {}
  ~Network() {
    if (lcm) lcm_destroy(lcm);
  }

  void subscribe(const std::string& channel, PacketHandler handler) {
    PacketHandler& slot = handlers.emplace_back(std::move(handler));
    // LCM takes the channel as a regular expression; a channel name is to be taken literally.
    std::string pattern;
    for (char c : channel)
      pattern += std::isalnum(static_cast<unsigned char>(c)) ? std::string(1, c) : fmt::format("[{}]", c);
    lcm_subscription_t* subscription = lcm_subscribe(lcm, pattern.c_str(), call_handler, &slot);
    if (!subscription) throw std::runtime_error(fmt::format("LCM: cannot subscribe to '{}'", channel));
    lcm_subscription_set_queue_capacity(subscription, kQueueMessages);
  }

  void send(const std::string& channel, const Packet& packet) {
    if (packet.size > 0) lcm_publish(lcm, channel.c_str(), packet.bytes, static_cast<unsigned>(packet.size));
  }
};

Wire::Wire(const std::string& url, const WireSetup& setup) : network_(std::make_unique<Network>(setup)) {
  network_->lcm = lcm_create(url.empty() ? nullptr : url.c_str());
  if (!network_->lcm)
    throw std::runtime_error(fmt::format("LCM: cannot use the network '{}' (is there a multicast route?)",
                                         url.empty() ? "LCM's default" : url));
}

Wire::~Wire() = default;

void Wire::on_arm_state(PacketHandler handler) {
  network_->subscribe(network_->channels.arm_state, std::move(handler));
}
void Wire::on_target(PacketHandler handler) {
  network_->subscribe(network_->channels.target, std::move(handler));
}
void Wire::on_obstacles(PacketHandler handler) {
  network_->subscribe(network_->channels.obstacles, std::move(handler));
}
void Wire::on_neighbour(size_t k, PacketHandler handler) {
  network_->subscribe(network_->neighbours.listen[k], std::move(handler));
}

void Wire::on_foreign_command(bool lockstep, std::function<void()> handler) {
  const auto listen = [this, lockstep, handler = std::move(handler), last = int64_t{-1}](Packet packet) mutable {
    const int64_t utime = utime_of(packet);
    if ((lockstep && utime == last) || !network_->sent_commands.has(utime)) handler();
    last = utime;
  };
  network_->subscribe(network_->channels.arm_command, listen);
}

bool Wire::receive(int timeout_ms) {
  return lcm_handle_timeout(network_->lcm, timeout_ms) > 0;
}

void Wire::publish(const Command& command, int64_t utime, int64_t seq) {
  network_->sent_commands.sent(utime);
  network_->send(network_->channels.arm_command, network_->encoder.encode(command, utime, seq));
}

void Wire::publish(const Report& report, const CycleRecord& record) {
  network_->send(network_->channels.controller_status, network_->encoder.encode(report, record));
}

void Wire::publish(const ArmState& arm, int64_t utime) {
  const std::string& channel = network_->neighbours.publish;
  if (!channel.empty()) network_->send(channel, network_->link_encoder.encode(arm, utime));
}

void Wire::publish(const LoopTiming& timing, int64_t utime) {
  network_->send(network_->channels.loop_timing, network_->encoder.encode(timing, utime));
}

}  // namespace sidestep
