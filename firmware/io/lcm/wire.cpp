#include "firmware/io/lcm/wire.h"

#include <fmt/format.h>
#include <lcm/lcm.h>

#include <atomic>

#include "firmware/base/fail.h"
#include "firmware/base/log.h"
#include "firmware/base/realtime.h"
#include "firmware/io/lcm/link_encoder.h"
#include "firmware/io/lcm/message_decoder.h"
#include "firmware/io/lcm/sent_messages.h"
#include "firmware/io/lcm/udp_receiver.h"

namespace sidestep {
namespace {

constexpr const char* kSelfTestChannel = "LCM_SELF_TEST";  // liblcm's
constexpr int kSelfTests = 50;
constexpr double kSelfTest_s = 0.1;

void warn_of_small_buffer(const UdpReceiver& receiver) {
  if (receiver.granted_buffer_bytes() >= receiver.wanted_buffer_bytes()) return;
  log_warning(
      fmt::format("the kernel grants a receive buffer of {} of {} bytes; sets of many obstacles may be lost (sysctl -w "
                  "net.core.rmem_max={})",
                  receiver.granted_buffer_bytes(), receiver.wanted_buffer_bytes(), receiver.wanted_buffer_bytes()));
}

}  // namespace

struct Wire::Network {
  Channels channels;
  Neighbours neighbours;
  UdpReceiver receiver;
  FragmentAssembly assembly{kLargestMessageBytes};
  std::vector<PacketHandler> handlers;  // by the number of the channel
  std::atomic<int64_t> malformed_datagrams{0}, incomplete_messages{0};
  double received_s = 0.0;  // of the last datagram
  lcm_t* lcm = nullptr;
  SentMessages sent_commands;
  Encoder encoder;
  LinkEncoder link_encoder;

  Network(const std::string& url, const WireSetup& setup)
      : channels(setup.channels),
        neighbours(setup.neighbours),
        receiver(multicast_group_of(url)),
        encoder(setup.arm, setup.dialect),
        link_encoder(setup.arm, setup.neighbours.world_from_base) {
    lcm = lcm_create(url.c_str());
    if (!lcm) fail("liblcm cannot send there");
  }
  ~Network() {
    if (lcm) lcm_destroy(lcm);
  }

  void subscribe(const std::string& channel, PacketHandler handler) {
    assembly.subscribe(channel);
    handlers.push_back(std::move(handler));
  }

  void send(const std::string& channel, const Packet& packet) {
    if (packet.size > 0) lcm_publish(lcm, channel.c_str(), packet.bytes, static_cast<unsigned>(packet.size));
  }

  bool receive(int timeout_ms) {
    if (!receiver.wait(timeout_ms)) return false;
    while (const UdpReceiver::Datagram* datagram = receiver.next()) {
      const auto message = assembly.add(datagram->sender, datagram->bytes);
      received_s = datagram->received_s;
      malformed_datagrams = assembly.malformed_datagrams();
      incomplete_messages = assembly.incomplete_messages();
      if (!message) continue;
      handlers[static_cast<size_t>(message->channel)](message->packet);
      return true;
    }
    return false;
  }

  /// A network that can be joined may still deliver nothing, because of a firewall for example.
  void test_reception() {
    subscribe(kSelfTestChannel, [](Packet) {});
    bool received = false;
    const double start_s = monotonic_s();
    for (int i = 1; i <= kSelfTests && !received; ++i) {
      lcm_publish(lcm, kSelfTestChannel, "sidestep", 8);
      while (!received && monotonic_s() < start_s + i * kSelfTest_s) received = receive(20);
    }
    if (!received) fail("nothing that is sent there comes back (does a firewall drop it?)");
  }
};

Wire::Wire(const std::string& url, const WireSetup& setup) {
  const std::string used_url = lcm_url_or_default(url);
  try {
    network_ = std::make_unique<Network>(used_url, setup);
    network_->test_reception();
  } catch (const std::exception& error) {
    fail("LCM: cannot use the network '{}': {}", used_url, error.what());
  }
  warn_of_small_buffer(network_->receiver);
}

Wire::~Wire() = default;

void Wire::on_arm_state(PacketHandler handler) {
  network_->subscribe(network_->channels.arm_state, std::move(handler));
}
void Wire::on_target(PacketHandler handler) {
  network_->subscribe(network_->channels.target, std::move(handler));
}
void Wire::on_joint_target(PacketHandler handler) {
  network_->subscribe(network_->channels.joint_target, std::move(handler));
}
void Wire::on_obstacles(PacketHandler handler) {
  network_->subscribe(network_->channels.obstacles, std::move(handler));
}
void Wire::on_other_joints(PacketHandler handler) {
  network_->subscribe(network_->channels.other_joints, std::move(handler));
}
void Wire::on_control(PacketHandler handler) {
  network_->subscribe(network_->channels.control, std::move(handler));
}
void Wire::on_attachments(PacketHandler handler) {
  network_->subscribe(network_->channels.attachments, std::move(handler));
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
  return network_->receive(timeout_ms);
}

double Wire::received_s() const {
  return network_->received_s;
}

Reception Wire::reception() const {
  return {network_->receiver.lost_datagrams(), network_->malformed_datagrams, network_->incomplete_messages};
}

void Wire::publish(const Command& command, int64_t utime, int64_t seq) {
  network_->sent_commands.sent(utime);
  network_->send(network_->channels.arm_command, network_->encoder.encode(command, utime, seq));
}

void Wire::publish(const Report& report, const CycleRecord& record) {
  network_->send(network_->channels.controller_status, network_->encoder.encode(report, record));
}

void Wire::publish(const ArmState& arm, const OtherFrames& others, int64_t utime) {
  const std::string& channel = network_->neighbours.publish;
  if (!channel.empty()) network_->send(channel, network_->link_encoder.encode(arm, others, utime));
}

void Wire::publish(const LoopTiming& timing, int64_t utime) {
  network_->send(network_->channels.loop_timing, network_->encoder.encode(timing, utime));
}

}  // namespace sidestep
