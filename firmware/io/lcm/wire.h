#pragma once

#include <functional>
#include <memory>
#include <string>

#include "firmware/io/lcm/channels.h"
#include "firmware/io/lcm/encoder.h"
#include "firmware/io/lcm/loop_timing.h"

namespace sidestep {

/// Called with the bytes of a message, which are valid during the call.
using PacketHandler = std::function<void(Packet packet)>;

/// What the wire of one controller needs to know. The arm outlives the wire.
struct WireSetup {
  const Channels& channels;
  const Neighbours& neighbours;
  const Dialect& dialect;
  const Arm& arm;
};

/// The LCM network: raw bytes in, commands and reports out.
///
/// liblcm only sends. It would receive with a thread that starts at the first subscription, of which liblcm 1.3.1 lets
/// two datagrams write outside its memory; UdpReceiver and FragmentAssembly receive in its place.
class Wire {
 public:
  /// url empty: LCM's default. Throws std::runtime_error when the network cannot be used, or when nothing that is sent
  /// there comes back. Warns when the kernel grants a smaller receive buffer than wanted.
  Wire(const std::string& url, const WireSetup& setup);
  ~Wire();

  /// Handlers run inside receive(), in the order of arrival, and must not throw. Call these before the first receive().
  void on_arm_state(PacketHandler handler);
  void on_target(PacketHandler handler);
  void on_joint_target(PacketHandler handler);
  void on_obstacles(PacketHandler handler);
  void on_other_joints(PacketHandler handler);
  void on_control(PacketHandler handler);
  void on_attachments(PacketHandler handler);
  /// Links of the k-th neighbour, k from 0.
  void on_neighbour(size_t k, PacketHandler handler);
  /// Commands on the own command channel that another process has sent. In lockstep all controllers of an arm answer
  /// with the same utime: there the second command with the same utime is foreign.
  void on_foreign_command(bool lockstep, std::function<void()> handler);

  /// Handles one message, or waits for one for at most timeout_ms. Returns whether one was handled. Returns early
  /// after a batch of datagrams without one.
  bool receive(int timeout_ms);

  /// When this machine received the packet that a handler is called with, monotonic clock. After a pause of the process
  /// many packets have waited: they are as old as that.
  double received_s() const;

  /// May be called from another thread than receive().
  Reception reception() const;

  /// Each sends without allocating; may be called from another thread than receive().
  void publish(const Command& command, int64_t utime, int64_t seq);
  void publish(const Report& report, const CycleRecord& record);
  void publish(const LoopTiming& timing, int64_t utime);
  /// The links of the measured arm, where neighbours.publish names a channel.
  void publish(const ArmState& arm, const OtherFrames& others, int64_t utime);

 private:
  struct Network;
  std::unique_ptr<Network> network_;
};

}  // namespace sidestep
